"""The signals that every step law has: what it is wired to, and what its output stage needs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.blocks.mode import Mode

#: The smallest time that a parameter may be set to [s].
SHORTEST_TIME = 1e-6
#: The largest magnitude of a gain or a limit that is taken for a reasonable one.
LARGEST_PARAMETER = 1e9


def wired_signals(
    prefix: str, count: int, wired: Sequence[Signal] | None, place: str
) -> tuple[Signal, ...]:
    """Return the process signals that a law is wired to, or nameless ones of unit 1.

    Raises
    ------
    InputError
        The number of signals is not `count`, or `count` is below one.

    Examples
    --------
    >>> [signal.name for signal in wired_signals("measurement", 2, None, "law")]
    ['measurement_1', 'measurement_2']
    """
    if count < 1:
        raise InputError(place, count, "at least 1", "give the number of signals of the law")
    if wired is None:
        return tuple(Signal(f"{prefix}_{number}") for number in range(1, count + 1))
    if len(wired) != count:
        raise InputError(
            place, [signal.name for signal in wired], f"{count} signals", "give one for each"
        )
    return tuple(wired)


def measurement_inputs(measured: Sequence[Signal]) -> list[Signal]:
    """Return measurement_j and sensor_j for each measured signal.

    Examples
    --------
    >>> [signal.name for signal in measurement_inputs([Signal("level_1", "V")])]
    ['measurement_1', 'sensor_1']
    """
    inputs = []
    for number, signal in enumerate(measured, start=1):
        inputs += [
            like(signal, f"measurement_{number}", f"measured {signal.name}"),
            Signal(
                f"sensor_{number}",
                low=0.0,
                high=1.0,
                initial=1.0,
                kind="boolean",
                description=f"sensor of {signal.name} is good",
            ),
        ]
    return inputs


def setpoint_inputs(controlled: Sequence[Signal]) -> list[Signal]:
    """Return setpoint_j for each controlled signal.

    Examples
    --------
    >>> setpoint_inputs([Signal("level_1", "V")])[0].name
    'setpoint_1'
    """
    return [
        like(signal, f"setpoint_{number}", f"setpoint of {signal.name}")
        for number, signal in enumerate(controlled, start=1)
    ]


def output_inputs(manipulated: Sequence[Signal]) -> list[Signal]:
    """Return mode_i, manual_i and tracking_i for each output, and the time step.

    Examples
    --------
    >>> [signal.name for signal in output_inputs([Signal("pump_1", "V")])]
    ['mode_1', 'manual_1', 'tracking_1', 'time_step']
    """
    inputs = []
    for number, signal in enumerate(manipulated, start=1):
        inputs += [
            Signal(
                f"mode_{number}",
                low=float(min(Mode)),
                high=float(max(Mode)),
                initial=float(Mode.AUTOMATIC),
                kind="integer",
                description=f"mode of {signal.name}: 0 manual, 1 automatic, 2 tracking",
            ),
            like(signal, f"manual_{number}", f"value of {signal.name} in manual"),
            like(signal, f"tracking_{number}", f"value of {signal.name} in tracking"),
        ]
    return [
        *inputs,
        Signal(
            "time_step",
            "s",
            low=0.0,
            initial=1.0,
            description="time since the last sample",
        ),
    ]


def limit_parameters(number: int, signal: Signal) -> list[Signal]:
    """Return low_limit_i and high_limit_i, initially the range of the signal.

    Examples
    --------
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> [(parameter.name, parameter.initial) for parameter in limit_parameters(1, pump)]
    [('low_limit_1', 0.0), ('high_limit_1', 10.0)]
    """
    low = signal.low if math.isfinite(signal.low) else 0.0
    high = signal.high if math.isfinite(signal.high) else 100.0
    return [
        gain(f"low_limit_{number}", signal.unit, low, f"low limit of {signal.name}"),
        gain(f"high_limit_{number}", signal.unit, high, f"high limit of {signal.name}"),
    ]


def tracking_time(number: int) -> Signal:
    """Return tracking_time_i of back-calculation.

    Examples
    --------
    >>> tracking_time(1).unit
    's'
    """
    return numbered([TRACKING_TIME], number)[0]


def numbered(entries: Iterable[Signal], number: int) -> list[Signal]:
    """Return signals with a number behind their names, as a law has them.

    Examples
    --------
    >>> [signal.name for signal in numbered([Signal("gain"), Signal("bias")], 2)]
    ['gain_2', 'bias_2']
    """
    return [replace(signal, name=f"{signal.name}_{number}") for signal in entries]


def output_parameters(number: int, signal: Signal, anti_windup: AntiWindup) -> list[Signal]:
    """Return low_limit_i and high_limit_i, and tracking_time_i for back-calculation.

    Examples
    --------
    >>> [p.name for p in output_parameters(1, Signal("pump_1", "V"), "back_calculation")]
    ['low_limit_1', 'high_limit_1', 'tracking_time_1']
    """
    parameters = limit_parameters(number, signal)
    if anti_windup == "back_calculation":
        parameters.append(tracking_time(number))
    return parameters


def integral_state(number: int, signal: Signal) -> Signal:
    """Return integral_i.

    Examples
    --------
    >>> integral_state(1, Signal("pump_1", "V")).unit
    'V'
    """
    return numbered([integral_of(signal)], number)[0]


def integral_of(signal: Signal) -> Signal:
    """Return integral.

    Examples
    --------
    >>> integral_of(Signal("pump_1", "V")).description
    'integral part of pump_1'
    """
    return Signal("integral", signal.unit, description=f"integral part of {signal.name}")


def last_output(number: int, signal: Signal) -> Signal:
    """Return last_output_i.

    Examples
    --------
    >>> last_output(1, Signal("pump_1", "V", initial=3.0)).initial
    3.0
    """
    return Signal(
        f"last_output_{number}",
        signal.unit,
        initial=signal.initial,
        description=f"{signal.name} in the last sample",
    )


def output_state(number: int, signal: Signal) -> list[Signal]:
    """Return integral_i and last_output_i.

    Examples
    --------
    >>> [state.name for state in output_state(1, Signal("pump_1", "V"))]
    ['integral_1', 'last_output_1']
    """
    return [integral_state(number, signal), last_output(number, signal)]


def output_signals(number: int, signal: Signal) -> list[Signal]:
    """Return manipulated_i and status_i.

    Examples
    --------
    >>> [output.name for output in output_signals(1, Signal("pump_1", "V"))]
    ['manipulated_1', 'status_1']
    """
    return [
        like(signal, f"manipulated_{number}", signal.description or f"value of {signal.name}"),
        Signal(
            f"status_{number}",
            low=0.0,
            high=255.0,
            kind="integer",
            description=(
                "sum of 1 automatic, 2 tracking, 4 at low limit, 8 at high limit, "
                "16 sensor fault, 32 invalid input, 64 invalid time step, 128 at rate limit"
            ),
        ),
    ]


def ratio_of_units(numerator: str, *denominators: str) -> str:
    """Return the unit of a gain.

    Examples
    --------
    >>> ratio_of_units("V", "m"), ratio_of_units("V", "V"), ratio_of_units("V", "V", "s")
    ('V/m', 'V/V', 'V/(V s)')
    >>> ratio_of_units("m^3/s", "mol/m^3")
    'm^3/s/(mol/m^3)'
    """
    below = [f"({unit})" if "/" in unit else unit for unit in denominators if unit != "1"]
    if not below:
        return numerator
    return f"{numerator}/({' '.join(below)})" if len(below) > 1 else f"{numerator}/{below[0]}"


def gain(name: str, unit: str, initial: float, description: str) -> Signal:
    """Return a parameter that may have either sign: a gain, a bias, a limit.

    Examples
    --------
    >>> gain("bias_1", "V", 3.0, "output at the operating point").initial
    3.0
    """
    return Signal(
        name,
        unit,
        low=-LARGEST_PARAMETER,
        high=LARGEST_PARAMETER,
        initial=initial,
        description=description,
    )


def coefficient(name: str, unit: str, description: str) -> Signal:
    """Return a number of a polynomial or a matrix from one sample to the next.

    Where a process is sampled often its poles stand near one, and six digits of such a number
    are fewer of a pole.

    Examples
    --------
    >>> coefficient("transition_1_1", "1", "effect of memory 1 on itself").digits
    9
    """
    return replace(gain(name, unit, 0.0, description), digits=9)


def size(name: str, unit: str, description: str) -> Signal:
    """Return a parameter above zero that is divided by or squared: a largest error, a noise.

    Examples
    --------
    >>> size("largest_error_1", "V", "largest acceptable error of level_1").low
    1e-12
    """
    return Signal(
        name, unit, low=1e-12, high=LARGEST_PARAMETER, initial=1.0, description=description
    )


def duration(name: str, description: str) -> Signal:
    """Return a parameter that is a time above zero [s].

    Examples
    --------
    >>> duration("integral_time_1", "integral time").unit
    's'
    """
    return Signal(
        name,
        "s",
        low=SHORTEST_TIME,
        high=LARGEST_PARAMETER,
        initial=60.0,
        description=description,
    )


def like_parameter(parameter: Signal, name: str) -> Signal:
    """Return a state or parameter with the unit and the range of another parameter.

    Examples
    --------
    >>> like_parameter(gain("proportional_gain_1", "V/m", 1.0, ""), "last_gain_1").unit
    'V/m'
    """
    return replace(parameter, name=name)


def setpoint_source(name: str, measurement: Signal, *, remote: bool = False) -> Signal:
    """Return the choice of a setpoint: 0 local, 1 remote.

    Examples
    --------
    >>> setpoint_source("setpoint_source_1", Signal("level"), remote=True).initial
    1.0
    """
    return Signal(
        name,
        low=0.0,
        high=1.0,
        initial=float(remote),
        kind="integer",
        description=f"source of the setpoint of {measurement.name}: 0 local, 1 remote",
    )


def like(signal: Signal, name: str, description: str) -> Signal:
    """Return a signal with the units and the range of another.

    Examples
    --------
    >>> like(Signal("level_1", "V", high=10.0), "setpoint_1", "setpoint of level_1").high
    10.0
    """
    return Signal(
        name,
        signal.unit,
        display_unit=signal.display_unit,
        low=signal.low,
        high=signal.high,
        initial=signal.initial,
        description=description,
    )


TRACKING_TIME = duration(
    "tracking_time", "time in which back-calculation takes the integral out of saturation"
)
