"""Whether a design method can be used, and the reason where it cannot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from clepsydra.base.errors import ClepsydraError


class NotApplicable(ClepsydraError):
    """A design method cannot give a controller for this process.

    Parameters
    ----------
    method : str
        "SIMC"
    reason : str
        In the reader's words.

    Examples
    --------
    >>> print(NotApplicable("LQI", "tank_3.level is not measured"))
    LQI is not applicable: tank_3.level is not measured.
    """

    def __init__(self, method: str, reason: str) -> None:
        self.method = method
        self.reason = reason
        super().__init__(f"{method} is not applicable: {reason}.")


@contextmanager
def reasons_about(what: str) -> Iterator[None]:
    """Put what a refusal is about before its reason.

    Examples
    --------
    >>> with reasons_about("level_1 by pump_1"):
    ...     raise NotApplicable("SIMC", "the element has no lag")
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: SIMC is not applicable: level_1 by pump_1: the \
element has no lag.
    """
    try:
        yield
    except NotApplicable as refusal:
        raise NotApplicable(refusal.method, f"{what}: {refusal.reason}") from None


@contextmanager
def as_reasons_of(method: str) -> Iterator[None]:
    """Tell why a method does not apply in the name of another, which is built on it.

    Examples
    --------
    >>> with as_reasons_of("fuzzy PI"):
    ...     raise NotApplicable("SIMC", "it has no delay")
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: fuzzy PI is not applicable: it has no delay.
    """
    try:
        yield
    except NotApplicable as refusal:
        raise NotApplicable(method, refusal.reason) from None
