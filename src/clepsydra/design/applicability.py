"""Whether a design method can be used, and the reason where it cannot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from clepsydra.base.errors import ClepsydraError, InputError
from clepsydra.controllers.parameters import check_parameters
from clepsydra.program.step_law import StepLaw


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
    clepsydra.design.applicability.NotApplicable: SIMC is not applicable: level_1 by pump_1: the \
element has no lag.
    """
    try:
        yield
    except NotApplicable as refusal:
        raise NotApplicable(refusal.method, f"{what}: {refusal.reason}") from None


def check_designed(law: StepLaw, values: Mapping[str, float], method: str) -> None:
    """Refuse a design whose own result no controller could run with.

    Raises
    ------
    NotApplicable

    Examples
    --------
    >>> from clepsydra.controllers.multiloop_pid import multiloop_pid_law
    >>> law = multiloop_pid_law(1)
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> check_designed(law, values | {"integral_time_1": 2e-8}, "SIMC")
    Traceback (most recent call last):
        ...
    clepsydra.design.applicability.NotApplicable: SIMC is not applicable: its integral_time_1 \
would be 2e-08, and a controller takes a number from 1e-06 to 1e+09 s.
    """
    try:
        check_parameters(law, values, method)
    except InputError as error:
        name = error.place.rpartition(", ")[2]
        raise NotApplicable(
            method,
            f"its {name} would be {values[name]:.3g}, and a controller takes {error.expected}",
        ) from None
