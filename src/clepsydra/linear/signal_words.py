"""A value and the range of a signal in words, in the unit that its reader sees."""

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si


def shown(signal: Signal, value: float, digits: int = 4) -> str:
    """Return a value of a signal with its unit.

    Examples
    --------
    >>> shown(Signal("level", "m", "cm"), 0.124), shown(Signal("share"), 0.5)
    ('12.4 cm', '0.5')
    """
    number = f"{from_si(float(value), signal.unit, signal.shown_unit):.{digits}g}"
    return number if signal.shown_unit == "1" else f"{number} {signal.shown_unit}"


def range_of(signal: Signal) -> str:
    """Return the range of a signal.

    Examples
    --------
    >>> range_of(Signal("pump_1", "V", low=0.0, high=10.0))
    'from 0 V to 10 V'
    """
    return f"from {shown(signal, signal.low)} to {shown(signal, signal.high)}"
