"""A controller's gain and times in the units that control systems ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from clepsydra.base.arguments import is_finite_number, require_type
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.designs.loops.pid_settings import (
    Action,
    ParallelSettings,
    PidSettings,
    SeriesSettings,
    to_parallel,
    to_series,
)


@dataclass(frozen=True)
class GainUnits:
    """The settings of one loop in every unit and form in use.

    Parameters
    ----------
    gain : float
        K, signed [input unit / output unit].
    unit : str
        "V/m"; empty for a share per share.
    percent_gain : float
        \\|K| in percent of the input per percent of the measurement, `Signal.percent_scale` [%/%].
    proportional_band : float
        100 / percent_gain [%]: how far the measurement moves to move the input by 100 %.
    action : {"reverse", "direct"}
        Whether the input rises or falls when the measurement falls.
    integral_time, derivative_time : float
        Ti, infinite without integral action, and Td [s].
    repeats_per_minute : float
        60 s / Ti [1/min]
    minutes_per_repeat : float
        Ti [min]
    derivative_minutes : float
        Td [min]
    series : SeriesSettings or None
        None where Ti < 4 Td and there is no series form.
    """

    gain: float
    unit: str
    percent_gain: float
    proportional_band: float
    action: Action
    integral_time: float
    derivative_time: float
    repeats_per_minute: float
    minutes_per_repeat: float
    derivative_minutes: float
    parallel: ParallelSettings
    series: SeriesSettings | None


def gain_units(settings: PidSettings, measurement: Signal, manipulated: Signal) -> GainUnits:
    """Return the settings of a loop in every unit and form.

    Parameters
    ----------
    measurement, manipulated : Signal
        Both with a finite range, or in percent.

    Raises
    ------
    InputError
        A range is not finite, the gain is zero or no number, or a time is out of range.

    References
    ----------
    ISA-TR5.9-2023, Proportional-Integral-Derivative (PID) Algorithms and Performance.

    Examples
    --------
    >>> volts = Signal("level", "V", low=0.0, high=10.0)
    >>> gain_units(PidSettings(4.0, 30.0), volts, volts).proportional_band
    25.0
    """
    _check(settings)
    shown = percent_gain(settings.gain, measurement, manipulated)
    minutes = settings.integral_time / 60.0
    has_series = settings.integral_time >= 4.0 * settings.derivative_time
    return GainUnits(
        gain=settings.gain,
        unit=unit_of_gain(measurement, manipulated),
        percent_gain=abs(shown),
        proportional_band=100.0 / abs(shown),
        action=settings.action,
        integral_time=settings.integral_time,
        derivative_time=settings.derivative_time,
        repeats_per_minute=1.0 / minutes,
        minutes_per_repeat=minutes,
        derivative_minutes=settings.derivative_time / 60.0,
        parallel=to_parallel(settings),
        series=to_series(settings) if has_series else None,
    )


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


def _check(settings: PidSettings) -> None:
    remedy = "make them: PidSettings(gain, Ti, Td)"
    require_type(settings, PidSettings, "settings", "PidSettings", remedy)
    gain, integral_time, derivative_time = settings
    if not is_finite_number(gain) or gain == 0.0:
        raise InputError("gain", gain, "a number that is not zero", "give the gain of the loop")
    if not integral_time > 0.0:
        expected = "a time above 0 s, or infinity"
        raise InputError("integral time", integral_time, expected, "give it in seconds")
    if not is_finite_number(derivative_time) or derivative_time < 0.0:
        raise InputError("derivative time", derivative_time, "a time from 0 s", "give seconds")


def _span(signal: Signal) -> float:
    if not signal.has_range:
        given = f"a range from {signal.low:g} to {signal.high:g} {signal.unit}"
        expected = "a finite range with its low end below its high end"
        raise InputError(signal.name, given, expected, "give the signal a range")
    return signal.percent_span
