"""A controller's gain in the units that control systems ask for."""

from __future__ import annotations

import math
from fractions import Fraction

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si


def unit_of_gain(measurement: Signal, manipulated: Signal) -> str:
    """Return the unit of a gain, empty for a share per share.

    Examples
    --------
    >>> share, flow = Signal("level"), Signal("inflow", "m^3/s")
    >>> unit_of_gain(share, flow), unit_of_gain(share, share), unit_of_gain(flow, flow)
    ('m^3/s', '', '(m^3/s)/(m^3/s)')
    """
    above, below = (
        f"({unit})" if "/" in unit else unit for unit in (manipulated.unit, measurement.unit)
    )
    if measurement.unit == "1":
        return "" if manipulated.unit == "1" else manipulated.unit
    return f"{above}/{below}"


def gain_factor(measurement: Signal, moved: Signal) -> float:
    """Return how many display units of a gain one SI unit of it is.

    Examples
    --------
    >>> level, pump = Signal("level", "m", display_unit="cm"), Signal("pump", "V")
    >>> gain_factor(level, pump)
    0.01
    """
    above, below = (from_si(1.0, signal.unit, signal.shown_unit) for signal in (moved, measurement))
    return above / below


def percent_gain(gain: float, measurement: Signal, manipulated: Signal) -> float:
    """Return a gain in percent of one signal per percent of the other, signed [%/%].

    Percent are those of each signal, `Signal.percent_scale`.

    Examples
    --------
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> percent_gain(4.0, level, Signal("pump", "V", low=0.0, high=10.0))
    2.0
    """
    return gain * _span(measurement) / _span(manipulated)


def gain_from_percent(percent: float, measurement: Signal, manipulated: Signal) -> float:
    """Return the gain in engineering units of a signed gain in %/%.

    Examples
    --------
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> gain_from_percent(2.0, level, Signal("pump", "V", low=0.0, high=10.0))
    4.0
    >>> gain_from_percent(3.03834, Signal("y", "A", low=0.004, high=0.02), Signal("u", "1", "%"))
    189.89625
    """
    moved, measured = _span(manipulated), _span(measurement)
    if not math.isfinite(percent):
        return percent
    # As decimals: a gain of few digits has few in other units too.
    gain, above, below = (Fraction(repr(float(each))) for each in (percent, moved, measured))
    return float(gain * above / below)


def _span(signal: Signal) -> float:
    if not signal.has_range:
        given = f"a range from {signal.low:g} to {signal.high:g} {signal.unit}"
        expected = "a finite range with its low end below its high end"
        raise InputError(signal.name, given, expected, "give the signal a range")
    return signal.percent_span
