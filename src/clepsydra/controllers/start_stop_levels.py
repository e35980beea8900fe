"""Start and stop levels: pumps that run or stand, with duty and standby."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, elements, path
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.ports import as_parts
from clepsydra.controllers.blocks.pump_order import pump_order
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "start/stop levels"
_OF_A_PUMP = (
    "mode", "running_value", "stopped_value", "low_limit", "high_limit", "in_service", "rested",
    "last_output",
)  # fmt: skip

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
    pump as it is; an operator can still move it by hand.

    Parameters
    ----------
    measured : sequence of Signal or str
        The level.
    manipulated : sequence of Signal or str
        The pumps, which lend their names, units and ranges; there are as many stages.

    Returns
    -------
    StepLaw
        Inputs pv and good of the level, mode, manual and tracking of each pump, and time_step
        [s]; parameters stage.J.start_level and stage.J.stop_level [unit of the level],
        alternation (0 or 1), shortest_rest [s], and of each pump running_value, stopped_value,
        low_limit, high_limit and in_service (0 or 1); state stage.J.on, duty (the place of a pump
        in their order), rested [s] and last_output of each pump; outputs out and status of each.

    Raises
    ------
    InputError
        There is no pump, one is named twice, or there is not one level.

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
    levels = signals.process_signals(measured, "start/stop law, measured")
    if len(levels) > 1:
        raise InputError(
            "start/stop law, measured", [signal.name for signal in levels], "one level",
            "name the one that starts and stops the pumps",
        )  # fmt: skip
    level, driven = levels[0], signals.process_signals(manipulated, "start/stop law, manipulated")
    stages = elements("stage", len(driven))
    return step_law(
        "start_stop_levels",
        inputs=[*signals.measurement_inputs([level]), *signals.output_inputs(driven)],
        parameters=[
            *(parameter for number, stage in enumerate(stages, 1)
              for parameter in _stage_parameters(stage, number, level)),
            _switch("alternation", "1 where the duty pump changes after each run"),
            Signal(
                "shortest_rest",
                "s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                description="least time between a stop and the next start of a pump",
            ),
            *(parameter for pump in driven for parameter in _pump_parameters(pump)),
        ],
        state=[
            *(
                Signal(path(stage, "on"), kind="boolean", low=0.0, high=1.0,
                       description=f"stage {number} on")
                for number, stage in enumerate(stages, start=1)
            ),
            Signal(
                "duty", kind="integer", low=1.0, high=float(len(driven)), initial=1.0,
                description="number of the pump whose turn it is",
            ),
            *(
                Signal(path(pump, "rested"), "s", initial=signals.LARGEST_PARAMETER,
                       description=f"time since {pump.name} stopped")
                for pump in driven
            ),
            *map(signals.last_output, driven),
        ],
        outputs=[signal for pump in driven for signal in signals.output_signals(pump)],
        equations=lambda symbols: _equations(symbols, level, driven, stages),
        description=_DESCRIPTION,
    )  # fmt: skip


def check_levels(values: Mapping[str, float], pumps: int, place: str) -> None:
    """Refuse levels that do not follow each other as the pumps need them.

    Parameters
    ----------
    values : mapping
        start_level and stop_level of each stage.
    pumps : int
    place : str
        The controller's name, for the message.

    Raises
    ------
    InputError
        A start level is its stop level or on its wrong side, or a stage starts before the one
        before it.

    Examples
    --------
    >>> check_levels({"stage.1.start_level": 1.0, "stage.1.stop_level": 0.5,
    ...               "stage.2.start_level": 0.9, "stage.2.stop_level": 0.6}, 2, "wet well")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: wet well, stage.2.start_level: got 0.9, expected a level \
beyond stage.1.start_level, 1; let each stage start after the one before it.
    """
    stages = [(path(s, "start_level"), path(s, "stop_level")) for s in elements("stage", pumps)]
    first, end = stages[0]
    sign = 1.0 if values[first] >= values[end] else -1.0
    side = "above" if sign > 0 else "below"
    for (before, _), (start, stop) in zip([("", ""), *stages], stages, strict=False):
        if not sign * (values[start] - values[stop]) > 0.0:
            raise InputError(
                f"{place}, {start}", values[start], f"a level {side} {stop}, {values[stop]:g}",
                "give every stage a start and a stop level, on the same side in all stages",
            )  # fmt: skip
        if before and not sign * (values[start] - values[before]) > 0.0:
            raise InputError(
                f"{place}, {start}", values[start],
                f"a level beyond {before}, {values[before]:g}",
                "let each stage start after the one before it",
            )  # fmt: skip


def _stage_parameters(stage: str, number: int, level: Signal) -> list[Signal]:
    words = f"{level.name} at which stage {number}"
    return [
        signals.gain(path(stage, what), level, 0.0, f"{words} {end}")
        for what, end in (("start_level", "begins"), ("stop_level", "ends"))
    ]


def _pump_parameters(pump: Signal) -> list[Signal]:
    low, high = signals.limit_parameters(pump)
    return [
        signals.gain(path(pump, "running_value"), pump, high.initial, f"{pump.name} while it runs"),
        signals.gain(
            path(pump, "stopped_value"), pump, low.initial, f"{pump.name} while it stands"
        ),
        low,
        high,
        _switch(path(pump, "in_service"), f"1 where {pump.name} may be started"),
    ]


def _switch(name: str, description: str) -> Signal:
    return Signal(name, kind="integer", low=0.0, high=1.0, initial=1.0, description=description)


def _equations(
    symbols: Symbols, measured: Signal, driven: Sequence[Signal], stages: Sequence[str]
) -> Equations:
    level, sound = symbols[path(measured, "pv")], symbols[path(measured, "good")]
    valid, time_step_good = is_number(level), is_time_step(symbols["time_step"])
    usable = ca.logic_and(ca.logic_and(valid, sound), time_step_good)
    passed = ca.if_else(time_step_good, symbols["time_step"], 0)
    pumps = [{part: symbols[path(pump, part)] for part in _OF_A_PUMP} for pump in driven]
    on = {path(stage, "on"): _stage(symbols, stage, level, usable) for stage in stages}
    demand = _total(on.values())
    runs = [pump["last_output"] != _stands_at(pump) for pump in pumps]
    rested = [pump["rested"] >= symbols["shortest_rest"] for pump in pumps]
    ready = [_ready(*each) for each in zip(pumps, runs, rested, strict=True)]
    order = pump_order(symbols["duty"], runs, ready, demand)
    before = _total(symbols[name] for name in on)
    ends = ca.logic_and(before > 0, demand == 0)
    rotates = ca.logic_and(ends, symbols["alternation"] == 1)
    state = {**on, "duty": ca.if_else(rotates, order.next_duty, symbols["duty"])}
    outputs: dict[str, ca.SX] = {}
    conditions: dict[str, ca.SX] = {}
    named: dict[str, ca.SX] = {"demand": demand}
    for moved, pump, running, is_ready, wanted in zip(
        driven, pumps, runs, ready, order.wanted, strict=True
    ):
        value = ca.if_else(wanted, pump["running_value"], pump["stopped_value"])
        element = final_element(symbols, moved, Asked(value, usable, valid, sound))
        manipulated = element.manipulated
        state |= as_parts(
            moved, {"rested": _rested(pump, manipulated, passed), "last_output": manipulated}
        )
        outputs |= as_parts(moved, {"out": manipulated, "status": element.status})
        conditions |= element.named
        named |= as_parts(moved, {"runs": running, "ready": is_ready, "wanted": wanted})
    return Equations(state, outputs, {**conditions, **named})


def _stage(symbols: Symbols, stage: str, level: ca.SX, usable: ca.SX) -> ca.SX:
    """Return whether a stage is on after this sample."""
    start, stop, now = (symbols[path(stage, part)] for part in ("start_level", "stop_level", "on"))
    empties = start > stop
    begins = ca.if_else(empties, level >= start, level <= start)
    ends = ca.if_else(empties, level <= stop, level >= stop)
    on = ca.if_else(ends, 0, ca.if_else(begins, 1, now))
    return ca.if_else(usable, on, now)


def _stands_at(pump: Symbols) -> ca.SX:
    return limit(pump["stopped_value"], pump["low_limit"], pump["high_limit"])


def _ready(pump: Symbols, runs: ca.SX, rested: ca.SX) -> ca.SX:
    """Return whether a pump may run in automatic."""
    automatic = pump["mode"] == Mode.AUTOMATIC
    has_leave = ca.logic_and(automatic, pump["in_service"] == 1)
    return ca.logic_and(has_leave, ca.logic_or(runs, rested))


def _rested(pump: Symbols, manipulated: ca.SX, passed: ca.SX) -> ca.SX:
    longer = ca.fmin(signals.LARGEST_PARAMETER, pump["rested"] + passed)
    return ca.if_else(manipulated != _stands_at(pump), 0, longer)


def _total(truths: Iterable[ca.SX]) -> ca.SX:
    total = ca.SX(0)
    for truth in truths:
        total = total + truth
    return total
