"""The signals that every step law has: what it is wired to, and what its output stage needs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from clepsydra.base.key import Key, ratio_of_units
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.blocks.status import STATUS_BITS, Mode, status_port
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of

#: The smallest time that a parameter may be set to [s].
SHORTEST_TIME = 1e-6
#: The largest magnitude of a gain or a limit that is taken for a reasonable one.
LARGEST_PARAMETER = 1e9
#: Parts that are a largest rate, of which the largest number is none, whatever its unit.
LARGEST_RATES = frozenset({"rate_limit", "setpoint_rate", "setpoint_ramp"})


#: What every measurement, and every controlled one, has in a law.
PV = Key("pv", "{measurement}", "measured {measurement}", like="measurement")
GOOD = Key("good", "1", "sensor of {measurement} is good", 0.0, 1.0, 1.0, kind="boolean")
SP = Key("sp", "{measurement}", "setpoint of {measurement}", like="measurement")
#: What every output has.
_MODES = "mode of {output}: 0 manual, 1 automatic, 2 tracking"
_LOW, _HIGH, _USUAL = map(float, (min(Mode), max(Mode), Mode.AUTOMATIC))
MODE = Key("mode", "1", _MODES, _LOW, _HIGH, _USUAL, kind="integer")
MANUAL = Key("manual", "{output}", "value of {output} in manual", like="output")
TRACKING = Key("tracking", "{output}", "value of {output} in tracking", like="output")
OUT = Key("out", "{output}", "value of {output}", like="output")
STATUS = status_port(STATUS_BITS)
LAST_OUTPUT = Key("last_output", "{output}", "{output} in the last sample")
INTEGRAL = Key("integral", "{output}", "integral part of {output}")
TIME_STEP = Key("time_step", "s", "time since the last sample", 0.0, default=1.0)


def signed(
    name: str, unit: str, words: str, default: float = 0.0, *, below: str = "", bolder: float = 0.0
) -> Key:
    """Return the key of a parameter that may have either sign: a gain, a bias, a limit."""
    ends = -LARGEST_PARAMETER, LARGEST_PARAMETER
    return Key(name, unit, words, *ends, default, below=below, bolder=bolder)


def growing(parameters: Iterable[Signal], power: float = 1.0) -> list[Signal]:
    """Return parameters as ones that grow where their law is made bolder.

    Examples
    --------
    >>> [each.bolder for each in growing([Signal("level.virtual_gain")], 2)]
    [2]
    """
    return [replace(each, bolder=power) for each in parameters]


def amount(name: str, unit: str, words: str, default: float = 0.0, *, low: float = 0.0) -> Key:
    """Return the key of a parameter that is not below zero, or above a smallest value."""
    return Key(name, unit, words, low, LARGEST_PARAMETER, default)


LOW_LIMIT = signed("low_limit", "{output}", "low limit of {output}", below="high_limit")
HIGH_LIMIT = signed("high_limit", "{output}", "high limit of {output}")
#: The largest number that it may have is none.
_RATE = "largest rate of change of {output}"
RATE_LIMIT = amount("rate_limit", "{output}/s", _RATE, LARGEST_PARAMETER)
_FADES = "time in which a bumpless start of {output} fades"
FADING_TIME = amount("fading_time", "s", _FADES, 60.0, low=SHORTEST_TIME)
_TRACKING = "time in which back-calculation takes the integral out of saturation"
TRACKING_TIME = amount("tracking_time", "s", _TRACKING, 60.0, low=SHORTEST_TIME)


def process_signals(given: Sequence[Signal | str]) -> list[Signal]:
    """Return the process signals of a law; one that has but a name is of unit 1."""
    return [Signal(each) if isinstance(each, str) else each for each in given]


def paired(
    measured: Sequence[Signal | str], manipulated: Sequence[Signal | str]
) -> list[tuple[Signal, Signal]]:
    """Return each measured signal of a law with the one that it moves."""
    return list(zip(process_signals(measured), process_signals(manipulated), strict=True))


def owners(signals: Iterable[Signal | DelayRing], part: str) -> tuple[str, ...]:
    """Return what the signals of a law belong to that are one part: of "pv", what it measures.

    Examples
    --------
    >>> owners(measurement_inputs([Signal("level_1", "V"), Signal("level_2", "V")]), "pv")
    ('level_1', 'level_2')
    """
    return tuple(
        signal.owner for signal in map(signal_of, signals) if signal.owner and signal.part == part
    )


def measurement_inputs(measured: Sequence[Signal]) -> list[Signal]:
    """Return pv and good of each measured signal."""
    return [key.of(signal, measurement=signal) for signal in measured for key in (PV, GOOD)]


def setpoint_inputs(controlled: Sequence[Signal]) -> list[Signal]:
    """Return sp of each controlled signal."""
    return [SP.of(signal, measurement=signal) for signal in controlled]


def output_inputs(manipulated: Sequence[Signal]) -> list[Signal]:
    """Return mode, manual and tracking of each output, and the time step.

    Examples
    --------
    >>> [signal.name for signal in output_inputs([Signal("pump_1", "V")])]
    ['pump_1.mode', 'pump_1.manual', 'pump_1.tracking', 'time_step']
    """
    inputs = [key.of(u, output=u) for u in manipulated for key in (MODE, MANUAL, TRACKING)]
    return [*inputs, TIME_STEP.of("")]


def limit_parameters(signal: Signal, *, rate_limited: bool = False) -> list[Signal]:
    """Return low_limit and high_limit, initially the range of the signal, and rate_limit.

    Examples
    --------
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> [(parameter.name, parameter.initial) for parameter in limit_parameters(pump)]
    [('pump_1.low_limit', 0.0), ('pump_1.high_limit', 10.0)]
    """
    low = signal.low if math.isfinite(signal.low) else 0.0
    high = signal.high if math.isfinite(signal.high) else 100.0
    found = [LOW_LIMIT.of(signal, low, output=signal), HIGH_LIMIT.of(signal, high, output=signal)]
    return [*found, RATE_LIMIT.of(signal, output=signal)] if rate_limited else found


def last_output(signal: Signal) -> Signal:
    """Return last_output of a process signal."""
    return LAST_OUTPUT.of(signal, signal.initial, output=signal)


def output_results(manipulated: Sequence[Signal]) -> tuple[Signal, ...]:
    """Return out and status of each output."""
    found: list[Signal] = []
    for u in manipulated:
        out = OUT.of(u, output=u)
        found.append(replace(out, description=u.description or out.description))
        found.append(replace(STATUS, name=path(u, "status")))
    return tuple(found)


def per(quantity: Signal, *others: Signal | str) -> Signal:
    """Return what has the units of one quantity for each of others, in SI and as shown.

    Examples
    --------
    >>> level, pump = Signal("level", "m", "cm"), Signal("pump", "1", "%")
    >>> gain = per(pump, level)
    >>> gain.unit, gain.display_unit, per(level, pump, "s").display_unit
    ('1/m', '%/cm', 'cm/(% s)')
    """
    units = [Signal("", o) if isinstance(o, str) else o for o in others]
    shown = ratio_of_units(quantity.shown_unit, *(each.shown_unit for each in units))
    return of_units(ratio_of_units(quantity.unit, *(each.unit for each in units)), shown)


def of_units(unit: str, shown: str) -> Signal:
    """Return what has a unit and one that it is shown in, which may be the same."""
    return Signal("", unit, shown if shown != unit else "")


def gain(name: str, of: Signal | str, initial: float, description: str) -> Signal:
    """Return a parameter that may have either sign: a gain, a bias, a limit.

    `of`: what has its units, see `per`; or the unit.
    """
    units = of_units(of, of) if isinstance(of, str) else of_units(of.unit, of.shown_unit)
    ends = -LARGEST_PARAMETER, LARGEST_PARAMETER
    return Signal(name, units.unit, units.display_unit, *ends, initial, description=description)


def coefficient(name: str, of: Signal | str, description: str) -> Signal:
    """Return a number of a polynomial or a matrix from one sample to the next.

    Where a process is sampled often its poles stand near one, and six digits of such a number
    are fewer of a pole.
    """
    return replace(gain(name, of, 0.0, description), digits=9)


def at_rest(signal: Signal, part: str) -> Signal:
    """Return the parameter of what a signal is at the operating point."""
    words = f"{signal.name} at the operating point"
    return gain(path(signal, part), signal, 0.0, words)


def size(name: str, of: Signal | str, description: str) -> Signal:
    """Return a parameter above zero that is divided by or squared: a largest error, a noise."""
    return replace(gain(name, of, 1.0, description), low=1e-12)


def duration(name: str, description: str) -> Signal:
    """Return a parameter that is a time above zero [s]."""
    return amount(name, "s", description, 60.0, low=SHORTEST_TIME).of("")


def like(signal: Signal, name: str, description: str) -> Signal:
    """Return a signal with the units and the range of another."""
    units, ends = (signal.unit, signal.display_unit), (signal.low, signal.high)
    return Signal(name, *units, *ends, signal.initial, description=description)
