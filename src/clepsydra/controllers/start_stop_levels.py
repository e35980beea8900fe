"""Start and stop levels: pumps that run or stand, with duty and standby."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.key import Key
from clepsydra.base.signal import Signal, elements, path
from clepsydra.base.units import from_si
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.ports import Asked, truth
from clepsydra.controllers.blocks.sample import Reading, Sample, control_law
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import is_time_step, limit
from clepsydra.program.step_law import StepLaw


def pump_order(
    duty: ca.SX, runs: Sequence[ca.SX], ready: Sequence[ca.SX], demand: ca.SX
) -> tuple[list[ca.SX], ca.SX]:
    """Return which pumps shall run, and the number of the pump behind the one that leads.

    As many run as are asked for, and no more.
    Those that run come first, so that no pump is stopped for another one; then they follow each
    other from the duty pump on, round and round. What is not ready is passed over.

    `duty`: number of the duty pump, from 1; `runs`, `ready`: truth values of each pump; `demand`:
    how many are to run.

    Examples
    --------
    Pump 2 is on duty, but in an operator's hand, and one pump is asked for:

    >>> yes, no = ca.DM(1), ca.DM(0)
    >>> wanted, next_duty = pump_order(ca.DM(2), (no, no, no), (yes, no, yes), ca.DM(1))
    >>> [bool(each) for each in wanted], float(next_duty)
    ([False, False, True], 3.0)
    """
    count = len(runs)
    turns = [i - duty + count * (i < duty) for i in range(1, count + 1)]

    def comes_first(j: int, i: int) -> ca.SX:
        earlier = ca.if_else(runs[i] == runs[j], turns[j] < turns[i], runs[j])
        return ca.logic_and(ready[j], earlier)

    wanted = []
    for i in range(count):
        before = sum(comes_first(j, i) for j in range(count) if j != i)
        wanted.append(ca.logic_and(ready[i], before < demand))
    lead = ca.SX(count)  # the turn of the first pump that runs in automatic
    for running, automatic, turn in zip(runs, ready, turns, strict=True):
        lead = ca.fmin(lead, ca.if_else(ca.logic_and(running, automatic), turn, count))
    behind = duty + ca.if_else(lead < count, lead, 0) + 1
    following = ca.if_else(behind > count, behind - count, behind)
    # The number of a pump, whatever stood there.
    return wanted, ca.fmin(count, ca.fmax(1, following))


FAMILY = "start/stop levels"
_DUTY = Key("duty", "1", "number of the pump whose turn it is", 1.0, default=1.0, kind="integer")
_FAR = signals.LARGEST_PARAMETER
_BETWEEN = "least time between a stop and the next start of a pump"
_REST = signals.amount("shortest_rest", "s", _BETWEEN)
_RESTED = Key("rested", "s", "time since {pump} stopped", default=_FAR)
_DESCRIPTION = (
    "Each stage begins at its start level and ends at its stop level; between them it stays.",
    "As many pumps run as there are stages: those that run, then the duty pump and those after it.",
    "A pump that is not in automatic or not in service, or that rests, leaves its place to the "
    "next.",
)


def start_stop_law(
    measured: Sequence[Signal | str], manipulated: Sequence[Signal | str]
) -> StepLaw:
    """Write the step law of pumps that are started and stopped by one level.

    Each stage begins where the level passes its start level and ends where it passes its stop
    level; between the two it stays as it is. As many pumps run as there are stages. Where the
    start levels lie above the stop levels the pumps empty the tank, and where they lie below they
    fill it.

    Pumps that run go on running; then the duty pump is next in turn, then those after it. When
    the last stage has ended, the turn passes to the pump behind the one that led, unless
    alternation is 0. A pump that is not in automatic, not in service, or has stood for less than
    the shortest rest, leaves its place to the next one. A fault of the level sensor leaves every
    pump as it is; an operator can still move it in manual.

    `measured`: the level; `manipulated`: the pumps, which lend their names, units and ranges; there
    are as many stages.

    References
    ----------
    R. L. Sanks (editor), Pumping Station Design, 2nd edition, Butterworth-Heinemann 1998.

    Examples
    --------
    The level passes 1.2 m, where the first of two pumps starts:

    >>> law = start_stop_law(["level"], ["duty", "standby"])
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> values |= {"stage.1.start_level": 1.2, "stage.1.stop_level": 0.8,
    ...            "stage.2.start_level": 2.0, "stage.2.stop_level": 1.6}
    >>> given = dict(pv=1.25, good=1, mode=1, time_step=2)
    >>> state, outputs, _ = law.function(
    ...     [signal.initial for signal in law.state],
    ...     [given.get(signal.part, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> [float(outputs[place]) for place in (0, 2)]
    [100.0, 0.0]
    """
    (level,), pumps = signals.process_signals(measured), signals.process_signals(manipulated)
    law = control_law(
        "start_stop_levels",
        lambda sample: _equations(sample, level, pumps),
        measured=[level],
        controlled=[],
        manipulated=pumps,
        description=_DESCRIPTION,
    )
    return replace(law, check=check_levels)


def check_levels(law: StepLaw, values: Mapping[str, float], place: str) -> None:
    """Refuse levels that do not follow each other as the pumps need them.

    `values`: start_level and stop_level of each stage [SI]; `place`: for the message.

    Raises InputError: A start level is its stop level or on its wrong side, or a stage starts
    before the one before it.

    Examples
    --------
    >>> law = start_stop_law([Signal("level", "m", "cm")], ["duty", "standby"])
    >>> check_levels(law, {"stage.1.start_level": 1.0, "stage.1.stop_level": 0.5,
    ...                    "stage.2.start_level": 0.9, "stage.2.stop_level": 0.6}, "wet well")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: wet well, stage.2.start_level: got '90 cm', expected a \
level beyond stage.1.start_level, 100 cm; let each stage start after the one before it.
    """
    shown = {
        p.name: f"{from_si(values[p.name], p.unit, p.shown_unit):.6g} {p.shown_unit}"
        for p in law.parameters
        if p.part in ("start_level", "stop_level")
    }
    stages = [
        (path(s, "start_level"), path(s, "stop_level"))
        for s in signals.owners(law.parameters, "start_level")
    ]
    first, end = stages[0]
    sign = 1.0 if values[first] >= values[end] else -1.0
    side = "above" if sign > 0 else "below"
    both = "give every stage a start and a stop level, on the same side in all stages"
    for (before, _), (start, stop) in zip([("", ""), *stages], stages, strict=False):
        for than, beyond, remedy in (
            (stop, side, both),
            (before, "beyond", "let each stage start after the one before it"),
        ):
            if than and not sign * (values[start] - values[than]) > 0.0:
                expected = f"a level {beyond} {than}, {shown[than]}"
                raise InputError(f"{place}, {start}", shown[start], expected, remedy)


def _pump_parameters(pump: Signal) -> list[Signal]:
    low, high = signals.limit_parameters(pump)
    runs, stands = f"{pump.name} while it runs", f"{pump.name} while it stands"
    return [
        _value(pump, path(pump, "running_value"), high.initial, runs),
        _value(pump, path(pump, "stopped_value"), low.initial, stands),
        low,
        high,
        _switch(path(pump, "in_service"), f"1 where {pump.name} may be started"),
    ]


def _value(signal: Signal, name: str, initial: float, description: str) -> Signal:
    """Return a parameter that is a value of a signal, beyond whose range it would do nothing."""
    found = signals.gain(name, signal, initial, description)
    low, high = max(found.low, signal.low), min(found.high, signal.high)
    return replace(found, low=low, high=high, initial=min(max(initial, low), high))


def _switch(name: str, description: str) -> Signal:
    return Signal(name, kind="integer", low=0.0, high=1.0, initial=1.0, description=description)


def _equations(sample: Sample, level: Signal, pumps: Sequence[Signal]) -> None:
    reading = Reading.of(sample, [level.name], [])
    time_step_good = is_time_step(sample["time_step"])
    usable = ca.logic_and(reading.known, time_step_good)
    passed = ca.if_else(time_step_good, sample["time_step"], 0)
    height = reading.measurements[level.name]
    on = {}
    for number, stage in enumerate(elements("stage", len(pumps)), start=1):
        (now,) = sample.memory(truth(path(stage, "on"), f"stage {number} on"))
        start, stop = sample.parameters(
            *(
                _value(level, path(stage, at), 0.0, f"{level.name} at which stage {number} {words}")
                for at, words in (("start_level", "begins"), ("stop_level", "ends"))
            )
        )
        on[path(stage, "on")] = ca.if_else(usable, _stage(start, stop, now, height), now)
    demand = sum(on.values(), ca.SX(0))
    alternates = _switch("alternation", "1 where the duty pump changes after each run")
    alternation, shortest_rest = sample.parameters(alternates, _REST.of(""))
    (duty,) = sample.memory(replace(_DUTY.of(""), high=float(len(pumps))))
    stands, runs, ready = [], [], []
    for pump in pumps:
        _, stopped, *limits, in_service = sample.parameters(*_pump_parameters(pump))
        rested, last = sample.memory(_RESTED.of(pump, pump=pump), signals.last_output(pump))
        stands.append(limit(stopped, *limits))
        runs.append(last != stands[-1])
        has_leave = ca.logic_and(sample[path(pump, "mode")] == Mode.AUTOMATIC, in_service == 1)
        has_rested = rested >= shortest_rest
        ready.append(ca.logic_and(has_leave, ca.logic_or(runs[-1], has_rested)))
    wanted, next_duty = pump_order(duty, runs, ready, demand)
    ends = ca.logic_and(sum(sample[name] for name in on) > 0, demand == 0)
    rotates = ca.logic_and(ends, alternation == 1)
    sample.next_state |= {**on, "duty": ca.if_else(rotates, next_duty, duty)}
    sample.named["demand"] = demand
    for i, pump in enumerate(pumps):
        running, stopped = sample.of(pump, "running_value", "stopped_value")
        value = ca.if_else(wanted[i], running, stopped)
        asked = Asked(value, usable, reading.numbers, reading.sensors)
        applied = final_element(sample, pump, asked).applied
        longer = ca.fmin(_FAR, sample[path(pump, "rested")] + passed)
        sample.next_state[path(pump, "rested")] = ca.if_else(applied != stands[i], 0, longer)
        sample.name(pump, {"runs": runs[i], "ready": ready[i], "wanted": wanted[i]})


def _stage(start: ca.SX, stop: ca.SX, now: ca.SX, level: ca.SX) -> ca.SX:
    """Return whether a stage is on at a level that is known."""
    empties = start > stop
    begins = ca.if_else(empties, level >= start, level <= start)
    ends = ca.if_else(empties, level <= stop, level >= stop)
    return ca.if_else(ends, 0, ca.if_else(begins, 1, now))
