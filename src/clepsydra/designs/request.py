"""What a user asked a design for, checked."""

from __future__ import annotations

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si


def positive_number(place: str, value: float, expected: str, remedy: str) -> float:
    """Return a number above zero.

    Parameters
    ----------
    place : str
        "SIMC, closed_loop_time_constant"
    value : float
        As given.
    expected, remedy : str
        For the message.

    Raises
    ------
    InputError
        It is no finite number above zero.

    Examples
    --------
    >>> positive_number("SIMC, closed_loop_time_constant", 30, "a time above 0 s", "use seconds")
    30.0
    """
    if not is_finite_number(value) or value <= 0.0:
        raise InputError(place, value, expected, remedy)
    return float(value)


def in_shown_unit(signal: Signal, value: float, digits: int = 3) -> str:
    """Return a value [signal unit] in the unit that the reader sees.

    Examples
    --------
    >>> in_shown_unit(Signal("level", "A", display_unit="mA"), 0.0016)
    '1.6 mA'
    """
    shown = f"{from_si(value, signal.unit, signal.shown_unit):.{digits}g}"
    return shown if signal.shown_unit == "1" else f"{shown} {signal.shown_unit}"
