"""Laws of matrices and of start and stop levels: their equations and numbers in display units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.status import STATUS_BITS, read_status
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import LARGEST_PARAMETER, owners
from clepsydra.loop.run import Run
from clepsydra.process.process import Process
from clepsydra.program.entries import signal_of
from clepsydra.report.facts import DIGITS, facts_table, known_signal, level_words
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    quantity_text,
    setting_time,
    settled_gains,
)

_OBSERVER = (
    "Observer: x̂ = x̂⁻ + M (y − y° − C x̂⁻) with the measurements of this sample, then for the next "
    "one x̂⁻ = Φ x̂ + Γ (u − u°), u being what was applied."
)


#: What the pumps of a controller of start and stop levels have in common.
_PUMPS: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("alternation", "the duty changes", lambda value: "after each run" if value else "never"),
    ("shortest_rest", "shortest rest of a pump", setting_time),
)
_Facts = list[tuple[str, str]]


def law_words(controller: Controller) -> list[str]:
    """Return what the law of a controller does in automatic, in equations.

    Returns
    -------
    list of str
        And what the law says of itself; empty for a scheme of blocks, whose loops say it
        themselves.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.lqi import design_lqi
    >>> controller = design_lqi(cl.load("quadruple-tank").linear)
    >>> law_words(controller)[0]
    'u = u° − F x + I within the limits, I⁺ = I + Δt G (r − y), x = y − y°, each sample. ° marks \
values at the operating point.'
    """
    description = list(controller.law.description)
    matrices = {parameter.matrix for parameter in controller.law.parameters}
    if "feedback" not in matrices:
        return description
    observed = "transition" in matrices
    state = "x = x̂" if observed else "x = y − y°"
    if "integral_gain" in matrices:
        words = f"u = u° − F x + I within the limits, I⁺ = I + Δt G (r − y), {state}, each sample."
    else:
        words = (
            f"u = u° − F x + N (r − r°) + b within the limits, {state}; b makes a change to "
            "automatic bumpless and fades in the fading time."
        )
    words += " ° marks values at the operating point."
    return [words, *([_OBSERVER] if observed else []), *description]


def law_grids(controller: Controller, process: Process) -> list[Table]:
    """Return the matrices of a controller with named rows and columns, in display units.

    A number is in the unit of its row per unit of its column. Levels of start and stop are a
    table of stages.

    Parameters
    ----------
    process : Process
        Lends display units.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> grid, _ = law_grids(cl.design.lqi(plant), plant.process)
    >>> grid.title, grid.head
    ('F, feedback', ('', 'level_1 [V]', 'level_2 [V]', 'level_3 [V]', 'level_4 [V]'))
    """
    if owners(controller.law.parameters, "start_level"):
        return [_stages(controller, process)]
    outputs = [process.signal(name) for name in controller.manipulated]
    measured = [process.signal(name) for name in controller.measurements]
    followed = [process.signal(name) for name in controller.setpoints]
    entries = [signal_of(entry) for entry in controller.law.state]
    estimated = [
        known_signal(process, Signal(each.owner, each.unit))
        for each in entries
        if each.part == "estimate"
    ]
    state = estimated or measured
    memory = [Signal(each.name, each.unit) for each in entries if each.owner == "memory"]
    named = (
        ("feedback", "F, feedback", outputs, state),
        ("integral_gain", "G, integral gain per s", outputs, followed),
        ("precompensator", "N, precompensator", outputs, followed),
        ("transition", "Φ, a sample later", estimated, estimated),
        ("input_effect", "Γ, held for a sample", estimated, outputs),
        ("observation", "C, shown by", measured, estimated),
        ("correction", "M, correction", estimated, measured),
        ("transition", "A, memory a sample later", memory, memory),
        ("error_effect", "B, errors", memory, followed),
        ("output_effect", "M, applied output", memory, outputs),
        ("memory_gain", "C, memory to output", outputs, memory),
        ("error_gain", "D, error to output", outputs, followed),
    )
    return [grid for each in named if (grid := _matrix(controller, *each)) is not None]


def law_facts(controller: Controller, process: Process) -> list[Table]:
    """Return operating point, limits and anti-windup of a controller without blocks."""
    if controller.law.blocks:
        return []
    found = [
        ("Operating point", _references(controller, process)),
        ("Pumps", _told(controller, _PUMPS)),
        *(
            (f"Output {name}", output_facts(process.signal(name), controller))
            for name in controller.manipulated
        ),
    ]
    return [facts_table(title, facts) for title, facts in found if facts]


def _references(controller: Controller, process: Process) -> _Facts:
    shown = ((name, process.signal(name)) for name in controller.measurements)
    named = ((path(name, "reference"), f"{name}°", _quantity(signal)) for name, signal in shown)
    return _told(controller, named)


def _quantity(signal: Signal) -> Callable[[float], str]:
    return lambda value: quantity_text(signal, value, DIGITS)


def _told(
    controller: Controller, named: Iterable[tuple[str, str, Callable[[float], str]]]
) -> _Facts:
    """Return each parameter that the controller has in words: its key, what it is, its text."""
    values = controller.values
    return [(what, text(values[key])) for key, what, text in named if key in values]


def _matrix(
    controller: Controller, stem: str, title: str, rows: Sequence[Signal], columns: Sequence[Signal]
) -> Table | None:
    declared = (each.name for each in controller.law.parameters if each.matrix == stem)
    values = {name: controller.values[name] for name in declared}
    names = [[path(path(row, stem), column.name) for column in columns] for row in rows]
    if not any(name in values for of_row in names for name in of_row):
        return None
    gains = np.array([[values.get(name, 0.0) for name in of_row] for of_row in names])
    return gains_table(title, settled_gains(gains, rows, columns), rows, columns, DIGITS)


def gains_table(
    title: str, gains: np.ndarray, rows: Sequence[Signal], columns: Sequence[Signal], digits: int
) -> Table:
    """Return gains [SI] from signals to others, in display units of the row per the column's.

    Examples
    --------
    >>> level, pump = Signal("level", "m", display_unit="cm"), Signal("pump", "V")
    >>> gains_table("", np.array([[0.02]]), [level], [pump], 3).rows
    (('level [cm]', '2.00'),)
    """
    factors = np.outer([display_factor(s) for s in rows], [1 / display_factor(s) for s in columns])
    down, across = ([_named(signal) for signal in signals] for signals in (rows, columns))
    body = (
        (name, *(number_text(gain, digits) for gain in of_row))
        for name, of_row in zip(down, (gains * factors).tolist(), strict=True)
    )
    return Table(title, ("", *across), tuple(body))


def _named(signal: Signal) -> str:
    unit = unit_text(signal.shown_unit)
    return f"{signal.name} [{unit}]" if unit else signal.name


def _stages(controller: Controller, process: Process) -> Table:
    level, values = process.signal(controller.measurements[0]), controller.values
    rows = []
    for number, stage in enumerate(owners(controller.law.parameters, "start_level"), start=1):
        ends = (values[path(stage, f"{what}_level")] for what in ("start", "stop"))
        words = (level_words(process, level, value) for value in ends)
        rows.append((f"stage {number}: {number} running", *words))
    title = f"Levels ({level.name})"
    return Table(title, ("", "starts at", "stops at"), tuple(rows))


def output_facts(signal: Signal, controller: Controller) -> list[tuple[str, str]]:
    """Return limits, rate limit, the value at rest and what else its law has of an output.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> pump = Signal("pump_1", "V", low=0.0, high=10.0)
    >>> values = {"pump_1.low_limit": 0.0, "pump_1.high_limit": 10.0}
    >>> controller = SimpleNamespace(values=values, initial_state={"pump_1.last_output": 3.0})
    >>> output_facts(pump, controller)
    [('output limits', '0 to 10.00 V'), ('output at rest', '3.000 V')]
    """
    values, state, shown = controller.values, controller.initial_state, _quantity(signal)
    rest, last = path(signal, "bias"), path(signal, "last_output")
    before = (
        (rest, f"{signal.name}°, at rest", shown),
        (path(signal, "running_value"), "while it runs", shown),
        (path(signal, "stopped_value"), "while it stands", shown),
    )
    facts = _told(controller, before)
    ends = [path(signal, f"{end}_limit") for end in ("low", "high")]
    if ends[0] in values:
        low, high = (shown(values[end]) for end in ends)
        facts.append(("output limits", f"{low.split(' ')[0]} to {high}"))
    rate = values.get(path(signal, "rate_limit"), LARGEST_PARAMETER)
    if rate < LARGEST_PARAMETER:
        facts.append(("rate limit", f"{shown(rate)} per s"))
    if last in state and rest not in values:
        facts.append(("output at rest", shown(state[last])))
    after = (
        (path(signal, "tracking_time"), "tracking time", setting_time),
        (path(signal, "fading_time"), "fading time", setting_time),
        (path(signal, "in_service"), "in service", lambda value: "yes" if value else "no"),
    )
    return facts + _told(controller, after)


def parameter_tables(controller: Controller) -> list[Table]:
    """Return the parameters of a controller, those that many things have in columns.

    "level_1.integral_time" and "level_2.integral_time" become the row "integral_time" with columns
    level_1 and level_2; "pump_1.feedback.level_3" stands in the row "pump_1.feedback", column
    level_3.
    """
    units = {signal.name: signal.unit for signal in controller.law.parameters}
    grouped: dict[tuple[str, str], dict[str, float]] = {}
    for name, value in controller.values.items():
        owner, part, element = [*name.split(".", 2), "", ""][:3]
        row, column = (f"{owner}.{part}", element) if element else (part or owner, part and owner)
        grouped.setdefault((row, units.get(name, "1")), {})[column] = value
    tables: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    for (row, unit), values in grouped.items():
        numbers = tuple(number_text(value, 4) for value in values.values())
        tables.setdefault(tuple(values), []).append((row, *numbers, unit_text(unit)))
    return [Table("", ("", *columns, "unit"), tuple(rows)) for columns, rows in tables.items()]


def status_words(run: Run) -> list[str]:
    """Return what the status words told, and for how long; outputs that told the same together.

    Returns
    -------
    list of str
        "pump_1, pump_2: the mode is automatic (14 min); the output stands at its high
        limit (12 s)"
    """
    outputs: dict[str, list[str]] = {}
    for name in run.controller.manipulated:
        seconds = dict.fromkeys(STATUS_BITS, 0.0)
        counted = np.unique(run.values[f"{name}.status"], return_counts=True)
        for word, samples in zip(*counted, strict=True):
            for bit in read_status(int(word)):
                seconds[bit] += float(samples) * run.scenario.sampling_period
        told = [
            f"{STATUS_BITS[bit].meaning} ({time_text(duration)})"
            for bit, duration in seconds.items()
            if duration
        ]
        words = "; ".join(told) or "the mode is manual, nothing else to tell"
        outputs.setdefault(words, []).append(name)
    return [f"{', '.join(names)}: {words}" for words, names in outputs.items()]
