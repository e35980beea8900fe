"""The alarms of a process as a step law: a block for each, wired to what it watches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, elements, owned, path
from clepsydra.controllers.alarms.acknowledgement import ACKNOWLEDGE, ACKNOWLEDGEMENT, STATE
from clepsydra.controllers.alarms.conditions import (
    DEADBAND,
    FILTER_TIME,
    LIMIT,
    RATE_DEADBAND,
    RATE_LIMIT,
    deviation_alarm,
    high_alarm,
    low_alarm,
    rate_alarm,
)
from clepsydra.controllers.alarms.flatline import MOVE, STILL, flatline_alarm
from clepsydra.controllers.alarms.timing import ACTIVE, OFF_DELAY, ON_DELAY, WATCHED
from clepsydra.controllers.blocks.ports import truth
from clepsydra.controllers.blocks.sample import Sample, written_law
from clepsydra.controllers.blocks.validity import all_of, any_of
from clepsydra.controllers.controller import Complexity, Controller
from clepsydra.controllers.signals import TIME_STEP, measurement_inputs, setpoint_inputs
from clepsydra.process.alarm import Alarm, AlarmKind
from clepsydra.process.process import Process
from clepsydra.program.block import Block
from clepsydra.program.entries import signal_of
from clepsydra.program.step_law import StepLaw

#: What it is called where controllers have their names.
NAME = "alarms"
#: Parts of an input of the process: what it was moved to in the last scan, and what an alarm asks.
COMMAND, INTERLOCK = "command", "interlock"
_BLOCKS = {
    AlarmKind.HIGH_HIGH: high_alarm,
    AlarmKind.HIGH: high_alarm,
    AlarmKind.LOW: low_alarm,
    AlarmKind.LOW_LOW: low_alarm,
    AlarmKind.DEVIATION: deviation_alarm,
    AlarmKind.RATE: rate_alarm,
}
_DESCRIPTION = (
    "Alarms on measurements, in the words of ISA-18.2: each comes when its condition has been "
    "there for its on-delay, and returns to normal when it has been gone for its off-delay.",
    "A measurement that is no number, or whose sensor is bad, leaves its alarms as they are.",
)


def alarm_controller(process: Process, *, operated: bool = False) -> Controller:
    """Return the alarms of a process as a controller that moves nothing.

    Inputs, beside those of any law: "pump_1.command", what a flatline alarm watches, as it was
    moved to in the last scan, and "acknowledge", where an alarm is acknowledged. Outputs:
    "level_1.high.active" of each alarm, "level_1.high.state" where it is acknowledged,
    "level_1.watched" of each measurement, and "pump_1.interlock" of each input that some alarm
    holds.

    `operated`: an operator has every alarm in a list, so that each has a state, whether the file
    has it acknowledged or not, and an input "level_1.high.acknowledge" in the place of the one of
    all; what the file does not have acknowledged holds its inputs no longer by that.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from dataclasses import replace
    >>> process = cl.load("quadruple-tank").process
    >>> alarms = alarm_controller(replace(process, alarms=(Alarm("level_1", AlarmKind.HIGH, 8.0),)))
    >>> [signal.name for signal in alarms.law.outputs], alarms.values["level_1.high.limit"]
    (['level_1.high.active', 'level_1.watched'], 8.0)
    """
    alarms = process.alarms
    law = alarm_law(alarms, process, operated=operated)
    free = {path(name, COMMAND): process.signal(name).initial for name in _watched(alarms)}
    free |= {signal.name: 0.0 for signal in _answers(alarms, operated=operated)}
    return Controller(
        name=NAME,
        family=NAME,
        design="Alarms of the process file.",
        law=law,
        values={parameter.name: parameter.initial for parameter in law.parameters},
        initial_state={signal_of(entry).name: 0.0 for entry in law.state},
        measurements=tuple(_measured(alarms)),
        setpoints=tuple(_compared(alarms)),
        manipulated=(),
        free_inputs=free,
        free_outputs=tuple(signal.name for signal in law.outputs),
        structure=Complexity.LOOPS,
    )


def alarm_law(alarms: Sequence[Alarm], process: Process, *, operated: bool = False) -> StepLaw:
    """Write the step law of alarms; `operated` as in `alarm_controller`."""
    measured = [process.signal(name) for name in _measured(alarms)]
    compared = [process.signal(name) for name in _compared(alarms)]
    watched = [process.signal(name) for name in _watched(alarms)]
    inputs = (
        *setpoint_inputs(compared),
        *measurement_inputs(measured),
        *(
            replace(
                u, name=path(u, COMMAND), description=f"{u.name} as it was moved in the last scan"
            )
            for u in watched
        ),
        *_answers(alarms, operated=operated),
        TIME_STEP.of(""),
    )
    outputs = (
        *(signal for alarm in alarms for signal in _told(alarm, process, operated=operated)),
        *(
            truth(path(name, WATCHED.name), f"{name} is known, so that its alarms look at it")
            for name in _measured(alarms)
        ),
        *(
            truth(path(name, INTERLOCK), f"an alarm holds {name} at its interlock value")
            for name in _held(alarms)
        ),
    )
    return written_law(
        NAME,
        lambda sample: _equations(sample, alarms, process, operated=operated),
        inputs,
        outputs,
        _DESCRIPTION,
    )


def _equations(
    sample: Sample, alarms: Sequence[Alarm], process: Process, *, operated: bool
) -> None:
    holds: dict[str, list[ca.SX]] = {name: [] for name in _held(alarms)}
    known: dict[str, list[ca.SX]] = {name: [] for name in _measured(alarms)}
    for alarm in alarms:
        block, owner = _block(alarm), alarm.name
        sample.parameters(*_parameters(alarm, process))
        sample.memory(*_state(owner, block))
        given = {
            f"input.{place}": sample[path(name, COMMAND)]
            for place, name in enumerate(alarm.moves, start=1)
        }
        found = sample.call(block, owner, owner, alarm.measurement, **given)
        sample.outputs[path(owner, ACTIVE.name)] = hold = found[ACTIVE.name]
        known[alarm.measurement].append(found[WATCHED.name])
        if operated or alarm.acknowledged:
            sample.memory(*_state(owner, ACKNOWLEDGEMENT))
            instance = path(owner, "acknowledgement")
            told = sample.call(ACKNOWLEDGEMENT, instance, owner, active=hold)
            sample.outputs[path(owner, STATE.name)] = told[STATE.name]
            if alarm.acknowledged:
                hold = told["holds"]
        for name in alarm.interlock:
            holds[name].append(hold)
    for name, each in known.items():
        sample.outputs[path(name, WATCHED.name)] = all_of(each)
    for name, each in holds.items():
        sample.outputs[path(name, INTERLOCK)] = any_of(each)


def _block(alarm: Alarm) -> Block:
    if alarm.kind is AlarmKind.FLATLINE:
        return flatline_alarm(len(alarm.moves))
    return _BLOCKS[alarm.kind]()


def _parameters(alarm: Alarm, process: Process) -> Iterator[Signal]:
    """Yield the parameters of an alarm, which are its numbers in the process file."""
    owner, measurement = alarm.name, process.signal(alarm.measurement)
    if alarm.kind is AlarmKind.FLATLINE:
        yield STILL.of(owner, alarm.limit, measurement=measurement)
        for name, (place, move) in zip(
            elements("move", len(alarm.moves)), alarm.moves.items(), strict=True
        ):
            key = replace(MOVE, name=name)
            yield key.of(owner, move, output=process.signal(place))
    else:
        of_rate = alarm.kind is AlarmKind.RATE
        limit, back = (RATE_LIMIT, RATE_DEADBAND) if of_rate else (LIMIT, DEADBAND)
        yield limit.of(owner, alarm.limit, measurement=measurement)
        yield back.of(owner, alarm.deadband, measurement=measurement)
        if of_rate:
            yield FILTER_TIME.of(owner, alarm.filter_time)
    yield ON_DELAY.of(owner, alarm.on_delay)
    yield OFF_DELAY.of(owner, alarm.off_delay)


def _told(alarm: Alarm, process: Process, *, operated: bool) -> Iterator[Signal]:
    words = alarm.words(process.signal(alarm.measurement))
    yield truth(path(alarm.name, ACTIVE.name), f"{words} is there; priority {alarm.priority.words}")
    if operated or alarm.acknowledged:
        yield replace(STATE, name=path(alarm.name, STATE.name))


def _answers(alarms: Sequence[Alarm], *, operated: bool) -> tuple[Signal, ...]:
    """Return by which inputs alarms are acknowledged."""
    if operated:
        return tuple(
            replace(ACKNOWLEDGE, name=path(alarm.name, ACKNOWLEDGE.name)) for alarm in alarms
        )
    return (ACKNOWLEDGE,) if any(alarm.acknowledged for alarm in alarms) else ()


def _measured(alarms: Sequence[Alarm]) -> dict[str, None]:
    return dict.fromkeys(alarm.measurement for alarm in alarms)


def _compared(alarms: Sequence[Alarm]) -> dict[str, None]:
    of = (alarm.measurement for alarm in alarms if alarm.kind is AlarmKind.DEVIATION)
    return dict.fromkeys(of)


def _watched(alarms: Sequence[Alarm]) -> dict[str, None]:
    return dict.fromkeys(name for alarm in alarms for name in alarm.moves)


def _held(alarms: Sequence[Alarm]) -> dict[str, None]:
    return dict.fromkeys(name for alarm in alarms for name in alarm.interlock)


def _state(owner: str, block: Block) -> list[Signal]:
    return owned(owner, map(signal_of, block.state))
