"""A value and the range of a signal in words, in the unit that its reader sees."""

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import digits_apart

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


def shown_apart(signal: Signal, value: float, limit: float) -> tuple[str, str]:
    """Return a value and a limit beyond which it lies, with digits that tell the two apart.

    Examples
    --------
    >>> shown_apart(Signal("level", "m"), 2.00003, 2.0), shown_apart(Signal("level", "m"), 2.5, 2.0)
    (('2.00003 m', '2 m'), ('2.5 m', '2 m'))
    """
    unit = signal.unit, signal.shown_unit
    digits = digits_apart(from_si(value, *unit), from_si(limit, *unit))
    return shown(signal, value, digits), shown(signal, limit, digits)


def beyond_of_range(signal: Signal, value: float) -> str:
    """Return a value and the range that it lies outside of.

    Examples
    --------
    >>> beyond_of_range(Signal("pump_1", "V", low=0.0, high=10.0), 10.0002)
    '10.0002 V, outside its range from 0 V to 10 V'
    """
    end = signal.high if value > signal.high else signal.low
    return f"{shown_apart(signal, value, end)[0]}, outside its range {range_of(signal)}"


def range_of(signal: Signal) -> str:
    """Return the range of a signal.

    Examples
    --------
    >>> range_of(Signal("pump_1", "V", low=0.0, high=10.0))
    'from 0 V to 10 V'
    """
    return f"from {shown(signal, signal.low)} to {shown(signal, signal.high)}"
