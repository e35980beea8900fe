"""Numbers and names as the reader sees them: display units, few digits, short names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text
from clepsydra.base.words import time_unit
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.process import Process


def number_text(value: float, digits: int = 3) -> str:
    """Return a number rounded to some significant digits, without trailing noise.

    Parameters
    ----------
    value : float
        May be infinite or not a number, printed as ∞ and as a dash.
    digits : int
        Significant digits.

    Examples
    --------
    >>> number_text(12.2629), number_text(-0.000123456), number_text(123456.0)
    ('12.3', '−1.23e−4', '123000')
    """
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.{digits - 1}e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if -4 < exponent < 6:
        text = f"{rounded:.{max(digits - 1 - exponent, 0)}f}"
    else:
        mantissa, power = f"{value:.{digits - 1}e}".split("e")
        text = f"{mantissa}e{int(power)}"
    return text.replace("-", "−")


def short_text(value: float) -> str:
    """Return a number in at most four digits and no more than it needs.

    Examples
    --------
    >>> short_text(20.000000000000004), short_text(-0.7)
    ('20', '−0.7')
    """
    return f"{value:.4g}".replace("-", "−")


def change_text(value: float, unit: str) -> str:
    """Return a change with its sign and unit, as `short_text`.

    Examples
    --------
    >>> change_text(0.5, "cm^3/s"), change_text(-2.0, "V")
    ('+0.5 cm³/s', '−2 V')
    """
    return f"{'' if value < 0 else '+'}{short_text(value)} {unit_text(unit)}".strip()


def time_cell(time: float) -> str:
    """Return a time [s] as a table shows it: in the unit that suits it, ∞ for no end.

    Examples
    --------
    >>> time_cell(43200.0), time_cell(math.inf), time_cell(math.nan)
    ('12.0 h', '∞', '–')
    """
    if not math.isfinite(time):
        return number_text(time)
    unit, length = time_unit(time)
    return f"{number_text(time / length)} {unit}"


def setting_time(time: float) -> str:
    """Return a time [s] that an engineer enters: in seconds, and from minutes on in these too.

    Examples
    --------
    >>> setting_time(30.0), setting_time(90519.0)
    ('30.00 s', '90520 s = 25.1 h')
    """
    words, shown = f"{number_text(time, 4)} s", time_cell(time)
    return words if shown.endswith(" s") or not math.isfinite(time) else f"{words} = {shown}"


def display_factor(signal: Signal) -> float:
    """Return how many display units one SI unit of the signal is.

    Examples
    --------
    >>> display_factor(Signal("tank_1.level", "m", display_unit="cm"))
    100.0
    """
    return from_si(1.0, signal.unit, signal.shown_unit)


def quantity_text(signal: Signal, value: float, digits: int = 3) -> str:
    """Return a signal's value [SI] in its display unit, with the unit.

    What is only rounding beside the signal's range is 0.

    Examples
    --------
    >>> quantity_text(Signal("tank_1.level", "m", display_unit="cm"), 0.122629)
    '12.3 cm'
    """
    shown = from_si(settled_reading(signal, value), signal.unit, signal.shown_unit)
    return f"{number_text(shown, digits)} {unit_text(signal.shown_unit)}".strip()


def fitted(name: str, letters: int) -> str:
    """Return a name with its middle left out where it is too long for its place.

    Examples
    --------
    >>> fitted("a_rather_long_tank_name", 15)
    'a_rathe…nk_name'
    """
    if len(name) <= letters:
        return name
    half = (letters - 1) // 2
    return f"{name[:half]}…{name[-half:]}"


@dataclass(frozen=True)
class SensorScale:
    """The straight line between a state and the measurement that shows it.

    Attributes
    ----------
    gain : float
        Measurement unit per state unit.
    offset : float
        Measurement where the state is zero.

    Examples
    --------
    >>> SensorScale(gain=50.0, offset=0.0).to_state(np.array([6.0]))  # [V] to [m]
    array([0.12])
    """

    gain: float
    offset: float

    def to_state(self, measurement: np.ndarray) -> np.ndarray:
        """Return the state [SI] that a measurement (or its setpoint) stands for."""
        return (measurement - self.offset) / self.gain


def percent_scale(process: Process, name: str) -> tuple[float, float] | None:
    """Return the values that 0 and 100 % of a signal stand for [unit]; None where it has no range.

    A state that a sensor measures has the percent that the sensor shows, and of several sensors
    that of a controlled one: so a reading, its setpoint, an axis and a table say the same. Any
    other signal has its own.

    Parameters
    ----------
    name : str
        A state, input, disturbance or measurement.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> percent_scale(load_process("quadruple-tank"), "tank_1.level")
    (0.0, 0.2)
    """
    scale = process.signal(name).percent_scale
    sensors = [element for element in process.elements if isinstance(element, Sensor)]
    showing = [
        sensor.name
        for sensor in sensors
        if name in (process.measured_state.get(sensor.name), sensor.quantity)
    ]
    if showing:
        shown = min(showing, key=lambda sensor: sensor not in process.controlled)
        ends = np.array(process.signal(shown).percent_scale)
        low, high = sensor_scale(process, shown).to_state(ends)
        scale = (float(low), float(high))
    return scale if math.isfinite(scale[1] - scale[0]) and scale[0] < scale[1] else None


def percent_text(process: Process, name: str, value: float, digits: int = 3) -> str:
    """Return a value [SI] of a signal in percent, with the sign; empty where it has no range.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> percent_text(load_process("quadruple-tank"), "tank_1.level", 0.124)
    '62.0 %'
    """
    scale = percent_scale(process, name)
    if scale is None:
        return ""
    return f"{number_text(100.0 * (value - scale[0]) / (scale[1] - scale[0]), digits)} %"


def sensor_scale(process: Process, measurement: str) -> SensorScale:
    """Read the scale of a sensor from the process's own measurement equation.

    The equation is evaluated at both ends of the state's range, so that the setpoint is drawn
    where the sensor would read it even if the sensor's range is not the tank's.

    Parameters
    ----------
    measurement : str
        A name in ``process.measured_state``.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> sensor_scale(load_process("quadruple-tank"), "level_1").gain  # [V/m]
    50.0
    """
    names = [signal.name for signal in process.state]
    place = names.index(process.measured_state[measurement])
    row = [signal.name for signal in process.measurements].index(measurement)
    level = process.state[place]
    readings = []
    for end in (level.low, level.high):
        state = np.array([signal.low for signal in process.state])
        state[place] = end
        output = process.measure(state, process.parameter_values)
        readings.append(float(np.asarray(output).ravel()[row]))
    gain = (readings[1] - readings[0]) / level.span
    return SensorScale(gain, readings[0] - gain * level.low)


#: Tanks that hold less [m³] count in the first unit, where their file names none.
_LARGE, _SMALL_FLOW, _LARGE_FLOW = 1.0, "cm^3/s", "m^3/h"


def flow_unit(process: Process) -> str:
    """Return the unit in which a plant counts flows: that of its own signals, if there is one.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> flow_unit(load_process("quadruple-tank"))
    'cm^3/s'
    """
    outside = (*process.inputs, *process.disturbances)
    own = [signal.shown_unit for signal in outside if signal.unit == "m^3/s"]
    if own:
        return own[0]
    held = [each.vessel.capacity for each in process.elements if isinstance(each, Tank)]
    return _SMALL_FLOW if max(held, default=0.0) < _LARGE else _LARGE_FLOW


def shown_signal(process: Process, measurement: str) -> tuple[Signal, float]:
    """Return what the reader sees of a measurement, and how much of the measurement one of it is.

    It is the state that it measures, as a level in cm behind a signal in V; the measurement
    itself where its band is in its unit, and a volume, which no straight line makes a level.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> signal, gain = shown_signal(load_process("quadruple-tank"), "level_1")
    >>> signal.name, gain  # [V/m]
    ('tank_1.level', 50.0)
    >>> shown_signal(load_process("averaging-tank"), "volume")[0].name
    'volume'
    """
    own, state = process.signal(measurement), process.measured_state.get(measurement)
    if state is None or measurement in process.bands or own.unit == "m^3":
        return own, 1.0
    return process.signal(state), sensor_scale(process, measurement).gain


#: Said in a report below the tables that show 0 for less.
RESOLUTION_WORDS = (
    "0 stands for less than a millionth of a signal's range, or of a step, which no transmitter "
    "tells from nothing; of an integral, for less than a billionth of the range adds up to in the "
    "whole run."
)

#: Share of a signal's range that a deviation has to reach before its digits mean anything: the
#: integration aims at it, and a transmitter of 16 bits has steps fifteen times as large.
DEVIATION = 1e-6
#: The same of the mean of what is integrated: a short transient adds up to little, and counts.
INTEGRAND = 1e-9
#: What of a value, or of a gain beside the others of its matrix, is only the computer's rounding.
ROUNDING = 1e-9


def settled(value: float, least: float) -> float:
    """Return a value, or 0 where it is smaller than the least that says something.

    Parameters
    ----------
    value, least : float
        In the same unit; a `least` that is not finite lets every value pass.

    Examples
    --------
    >>> settled(1.04e-12, 1e-4), settled(-3.0, 1e-4)
    (0.0, -3.0)
    """
    return 0.0 if math.isfinite(least) and abs(value) < least else value


def settled_reading(signal: Signal, value: float) -> float:
    """Return a value of a signal [SI] without what is only rounding beside its range.

    Examples
    --------
    >>> settled_reading(Signal("pump", "V", low=0.0, high=10.0), 1e-12)
    0.0
    """
    return settled(value, ROUNDING * signal.span)


def settled_gains(
    gains: np.ndarray, rows: Sequence[Signal], columns: Sequence[Signal]
) -> np.ndarray:
    """Return gains [SI] with 0 for those that are rounding beside the largest of them.

    They are compared in shares of the ranges of their rows and columns; a signal without a range
    counts as it is.

    Parameters
    ----------
    gains : ndarray [rows, columns]

    Examples
    --------
    >>> pump, level = Signal("pump", "V", low=0.0, high=10.0), Signal("level", "m", low=0.0, high=1)
    >>> settled_gains(np.array([[2.0, 3e-15]]), [pump], [level, level])
    array([[2., 0.]])
    """
    sizes = np.outer([1.0 / _width(s) for s in rows], [_width(s) for s in columns])
    shares = np.abs(gains) * sizes
    return np.where(shares < ROUNDING * np.max(shares, initial=0.0), 0.0, gains)


def _width(signal: Signal) -> float:
    return signal.span if 0.0 < signal.span < math.inf else 1.0
