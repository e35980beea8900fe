"""Whether a design method can be used, and the reason where it cannot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from clepsydra.base.errors import ClepsydraError, InputError


class NotApplicable(ClepsydraError):
    """A design method cannot give a controller for this process.

    Parameters
    ----------
    reason : str
        In the reader's words.
    method : str, optional
        "SIMC"; what a design is made of leaves it out, and the design says it, see `told_by`.

    Examples
    --------
    >>> print(NotApplicable("tank_3.level is not measured", "LQI"))
    LQI is not applicable: tank_3.level is not measured.
    """

    def __init__(self, reason: str, method: str = "") -> None:
        self.method = method
        self.reason = reason
        super().__init__(f"{method} is not applicable: {reason}." if method else f"{reason}.")


@contextmanager
def reasons_about(what: str) -> Iterator[None]:
    """Put what a refusal is about before its reason.

    Examples
    --------
    >>> with reasons_about("level_1 by pump_1"):
    ...     raise NotApplicable("the element has no lag")
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: level_1 by pump_1: the element has no lag.
    """
    try:
        yield
    except NotApplicable as refusal:
        raise NotApplicable(f"{what}: {refusal.reason}", refusal.method) from None


@contextmanager
def told_by(method: str) -> Iterator[None]:
    """Let refusals and mistakes within say which method found them; of two, the outer one refuses.

    Examples
    --------
    >>> with told_by("fuzzy PI"), told_by("SIMC"):
    ...     raise NotApplicable("it has no delay")
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: fuzzy PI is not applicable: it has no delay.
    """
    try:
        yield
    except NotApplicable as refusal:
        raise NotApplicable(refusal.reason, method) from None
    except InputError as error:
        raise InputError(
            f"{method}, {error.place}", error.value, error.expected, error.remedy
        ) from None
