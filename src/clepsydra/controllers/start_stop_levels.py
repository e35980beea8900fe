"""Start and stop levels: pumps that run or stand, with duty and standby."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.controllers import signals
from clepsydra.controllers.blocks.final_element import FinalElement, final_element
from clepsydra.controllers.blocks.handover import Asked
from clepsydra.controllers.blocks.limits import limit
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.pump_order import PumpOrder, pump_order
from clepsydra.controllers.blocks.validity import is_number, is_time_step
from clepsydra.program.step_law import Equations, StepLaw, Symbols, step_law

FAMILY = "start/stop levels"

_DESCRIPTION = (
    "Stage j begins at start_level_j and ends at stop_level_j; between them it stays.",
    "As many pumps run as there are stages: those that run, then the duty pump and those after it.",
    "A pump that is not in automatic or not in service, or that rests, leaves its place to the "
    "next.",
)


def start_stop_law(
    pumps: int, *, measured: Signal | None = None, manipulated: Sequence[Signal] | None = None
) -> StepLaw:
    """Write the step law of pumps that are started and stopped by one level.

    Stage j begins where the level passes start_level_j and ends where it passes stop_level_j;
    between the two it stays as it is. As many pumps run as there are stages. Where the start
    levels lie above the stop levels the pumps empty the tank, and where they lie below they fill
    it.

    Pumps that run go on running; then the duty pump is next in turn, then those after it. When
    the last stage has ended, the turn passes to the pump behind the one that led, unless
    alternation is 0. A pump that is not in automatic, not in service, or has stood for less than
    the shortest rest, leaves its place to the next one. A fault of the level sensor leaves every
    pump as it is; an operator can still move it by hand.

    Parameters
    ----------
    pumps : int
        n; there are as many stages.
    measured : Signal, optional
        The level.
    manipulated : sequence of Signal, optional
        The pumps' signals: they lend their units and ranges.

    Returns
    -------
    StepLaw
        Inputs measurement_1, sensor_1, mode_i, manual_i, tracking_i and time_step [s]; parameters
        start_level_j and stop_level_j [measurement unit], alternation (0 or 1), shortest_rest
        [s], and for each pump running_value_i, stopped_value_i, low_limit_i, high_limit_i and
        in_service_i (0 or 1); state stage_j, duty (a pump's number), rested_i [s],
        last_output_i; outputs manipulated_i, status_i.

    Raises
    ------
    InputError
        There is no pump, or the signals do not match the number.

    References
    ----------
    R. L. Sanks (editor), Pumping Station Design, 2nd edition, Butterworth-Heinemann 1998.

    Examples
    --------
    The level passes 1.2 m, where the first of two pumps starts:

    >>> law = start_stop_law(2)
    >>> values = {parameter.name: parameter.initial for parameter in law.parameters}
    >>> values |= dict(start_level_1=1.2, stop_level_1=0.8, start_level_2=2.0, stop_level_2=1.6)
    >>> given = dict(measurement_1=1.25, sensor_1=1, mode_1=1, mode_2=1, time_step=2)
    >>> state, outputs, _ = law.function(
    ...     [signal.initial for signal in law.state],
    ...     [given.get(signal.name, 0) for signal in law.inputs],
    ...     [values[signal.name] for signal in law.parameters],
    ... )
    >>> [float(outputs[place]) for place in (0, 2)]
    [100.0, 0.0]
    """
    (level,) = signals.wired_signals(
        "measurement", 1, None if measured is None else [measured], "start/stop law, measured"
    )
    driven = signals.wired_signals("output", pumps, manipulated, "start/stop law, manipulated")
    numbers = range(1, pumps + 1)
    return step_law(
        "start_stop_levels",
        inputs=[*signals.measurement_inputs([level]), *signals.output_inputs(driven)],
        parameters=[
            *(parameter for j in numbers for parameter in _stage_parameters(j, level)),
            _switch("alternation", "1 where the duty pump changes after each run"),
            Signal(
                "shortest_rest",
                "s",
                low=0.0,
                high=signals.LARGEST_PARAMETER,
                description="least time between a stop and the next start of a pump",
            ),
            *(p for i, pump in enumerate(driven, start=1) for p in _pump_parameters(i, pump)),
        ],
        state=[
            *(
                Signal(f"stage_{j}", kind="boolean", low=0.0, high=1.0, description=f"stage {j} on")
                for j in numbers
            ),
            Signal(
                "duty", kind="integer", low=1.0, high=float(pumps), initial=1.0,
                description="number of the pump whose turn it is",
            ),
            *(
                Signal(
                    f"rested_{i}", "s", initial=signals.LARGEST_PARAMETER,
                    description=f"time since {pump.name} stopped",
                )
                for i, pump in enumerate(driven, start=1)
            ),
            *(signals.last_output(i, pump) for i, pump in enumerate(driven, start=1)),
        ],
        outputs=[s for i, pump in enumerate(driven, start=1) for s in
                 signals.output_signals(i, pump)],
        equations=lambda symbols: _equations(symbols, driven),
        description=_DESCRIPTION,
    )  # fmt: skip


def check_levels(values: Mapping[str, float], pumps: int, place: str) -> None:
    """Refuse levels that do not follow each other as the pumps need them.

    Parameters
    ----------
    values : mapping
        start_level_j and stop_level_j.
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
    >>> check_levels(dict(start_level_1=1.0, stop_level_1=0.5,
    ...                   start_level_2=0.9, stop_level_2=0.6), 2, "wet well")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: wet well, start_level_2: got 0.9, expected a level beyond \
start_level_1, 1; let each stage start after the one before it.
    """
    sign = 1.0 if values["start_level_1"] >= values["stop_level_1"] else -1.0
    side = "above" if sign > 0 else "below"
    for j in range(1, pumps + 1):
        start, stop = values[f"start_level_{j}"], values[f"stop_level_{j}"]
        if not sign * (start - stop) > 0.0:
            raise InputError(
                f"{place}, start_level_{j}", start, f"a level {side} stop_level_{j}, {stop:g}",
                "give every stage a start and a stop level, on the same side in all stages",
            )  # fmt: skip
        if j > 1 and not sign * (start - values[f"start_level_{j - 1}"]) > 0.0:
            raise InputError(
                f"{place}, start_level_{j}", start,
                f"a level beyond start_level_{j - 1}, {values[f'start_level_{j - 1}']:g}",
                "let each stage start after the one before it",
            )  # fmt: skip


def _stage_parameters(number: int, level: Signal) -> list[Signal]:
    return [
        signals.gain(
            f"{what}_level_{number}", level.unit, 0.0, f"{level.name} at which stage {number} {end}"
        )
        for what, end in (("start", "begins"), ("stop", "ends"))
    ]


def _pump_parameters(number: int, pump: Signal) -> list[Signal]:
    low, high = signals.limit_parameters(number, pump)
    return [
        signals.gain(
            f"running_value_{number}", pump.unit, high.initial, f"{pump.name} while it runs"
        ),
        signals.gain(
            f"stopped_value_{number}", pump.unit, low.initial, f"{pump.name} while it stands"
        ),
        low,
        high,
        _switch(f"in_service_{number}", f"1 where {pump.name} may be started"),
    ]


def _switch(name: str, description: str) -> Signal:
    return Signal(name, kind="integer", low=0.0, high=1.0, initial=1.0, description=description)


def _equations(symbols: Symbols, driven: Sequence[Signal]) -> Equations:
    numbers = range(1, len(driven) + 1)
    level, sound = symbols["measurement_1"], symbols["sensor_1"]
    valid, time_step_good = is_number(level), is_time_step(symbols["time_step"])
    usable = ca.logic_and(ca.logic_and(valid, sound), time_step_good)
    passed = ca.if_else(time_step_good, symbols["time_step"], 0)
    stages = {f"stage_{j}": _stage(symbols, j, usable) for j in numbers}
    demand = _total(stages.values())
    runs = [_runs(symbols, i) for i in numbers]
    ready = [_ready(symbols, i, runs[i - 1]) for i in numbers]
    order = pump_order(symbols["duty"], runs, ready, demand)
    elements: list[FinalElement] = []
    for i in numbers:
        value = ca.if_else(
            order.wanted[i - 1], symbols[f"running_value_{i}"], symbols[f"stopped_value_{i}"]
        )
        asked = Asked(value, usable, valid, sound)
        elements.append(final_element(symbols, i, driven[i - 1], asked))
    before = _total(symbols[name] for name in stages)
    ends = ca.logic_and(before > 0, demand == 0)
    rotates = ca.logic_and(ends, symbols["alternation"] == 1)
    state = {**stages, "duty": ca.if_else(rotates, order.next_duty, symbols["duty"])}
    outputs: dict[str, ca.SX] = {}
    for i, element in zip(numbers, elements, strict=True):
        state |= _rested(symbols, i, element, passed)
        state[f"last_output_{i}"] = element.manipulated
        outputs |= {f"manipulated_{i}": element.manipulated, f"status_{i}": element.status}
    return Equations(state, outputs, _named(elements, order, demand, runs, ready))


def _stage(symbols: Symbols, number: int, usable: ca.SX) -> ca.SX:
    """Return whether a stage is on after this sample."""
    level = symbols["measurement_1"]
    start, stop = symbols[f"start_level_{number}"], symbols[f"stop_level_{number}"]
    empties = start > stop
    begins = ca.if_else(empties, level >= start, level <= start)
    ends = ca.if_else(empties, level <= stop, level >= stop)
    on = ca.if_else(ends, 0, ca.if_else(begins, 1, symbols[f"stage_{number}"]))
    return ca.if_else(usable, on, symbols[f"stage_{number}"])


def _stands_at(symbols: Symbols, number: int) -> ca.SX:
    low, high = symbols[f"low_limit_{number}"], symbols[f"high_limit_{number}"]
    return limit(symbols[f"stopped_value_{number}"], low, high)


def _runs(symbols: Symbols, number: int) -> ca.SX:
    """Return whether a pump runs, by whoever's hand."""
    return symbols[f"last_output_{number}"] != _stands_at(symbols, number)


def _ready(symbols: Symbols, number: int, runs: ca.SX) -> ca.SX:
    """Return whether a pump may run in automatic."""
    automatic = symbols[f"mode_{number}"] == Mode.AUTOMATIC
    rested = symbols[f"rested_{number}"] >= symbols["shortest_rest"]
    has_leave = ca.logic_and(automatic, symbols[f"in_service_{number}"] == 1)
    return ca.logic_and(has_leave, ca.logic_or(runs, rested))


def _rested(
    symbols: Symbols, number: int, element: FinalElement, passed: ca.SX
) -> dict[str, ca.SX]:
    name = f"rested_{number}"
    longer = ca.fmin(signals.LARGEST_PARAMETER, symbols[name] + passed)
    return {name: ca.if_else(element.manipulated != _stands_at(symbols, number), 0, longer)}


def _total(truths: Iterable[ca.SX]) -> ca.SX:
    total = ca.SX(0)
    for truth in truths:
        total = total + truth
    return total


def _named(
    elements: Sequence[FinalElement],
    order: PumpOrder,
    demand: ca.SX,
    runs: Sequence[ca.SX],
    ready: Sequence[ca.SX],
) -> dict[str, ca.SX]:
    named = {name: value for element in elements for name, value in element.named.items()}
    named["demand"] = demand
    for i, values in enumerate(zip(runs, ready, order.wanted, strict=True), start=1):
        named |= dict(zip((f"runs_{i}", f"ready_{i}", f"wanted_{i}"), values, strict=True))
    return named
