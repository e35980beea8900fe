"""A value and the range of a signal in words, in the unit that its reader sees."""

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text

#: What is less than this share of a range is nothing.
_ROUNDING = 1e-9


def shown(signal: Signal, value: float, digits: int = 4) -> str:
    """Return a value of a signal with its unit.

    Examples
    --------
    >>> shown(Signal("feed", "m^3/s", "m^3/h"), 0.005), shown(Signal("share"), 0.5)
    ('18 m³/h', '0.5')
    """
    if signal.has_range and abs(value) <= _ROUNDING * signal.span:
        value = 0.0
    number = f"{from_si(float(value), signal.unit, signal.shown_unit):.{digits}g}"
    return f"{number} {unit_text(signal.shown_unit)}".strip()


def range_of(signal: Signal) -> str:
    """Return the range of a signal.

    Examples
    --------
    >>> range_of(Signal("pump_1", "V", low=0.0, high=10.0))
    'from 0 V to 10 V'
    """
    return f"from {shown(signal, signal.low)} to {shown(signal, signal.high)}"
