"""Laws of matrices and of start and stop levels: their equations and numbers in display units."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.process.process import Process
from clepsydra.program.entries import signal_of
from clepsydra.report.facts import DIGITS, facts_table, known_signal, level_words
from clepsydra.report.output_facts import output_facts
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    quantity_text,
    setting_time,
    unit_text,
)
from clepsydra.report.resolution import settled_gains

_OBSERVER = (
    "Observer: x̂ = x̂⁻ + M (y − y° − C x̂⁻) with the measurements of this sample, then for the next "
    "one x̂⁻ = Φ x̂ + Γ (u − u°), u being what was applied."
)


def law_words(controller: Controller) -> list[str]:
    """Return what the law of a controller does in automatic, in equations.

    Parameters
    ----------
    controller : Controller

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
    values = controller.values
    parts = {part for name in values for part in name.split(".")}
    if "feedback" not in parts:
        return description
    observed = "transition" in parts
    state = "x = x̂" if observed else "x = y − y°"
    if "integral_gain" in parts:
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
    controller : Controller
    process : Process
        Lends display units.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> grid, _ = law_grids(cl.design.lqi(plant), plant.process)
    >>> grid.head
    ('F, feedback', 'level_1 [V]', 'level_2 [V]', 'level_3 [V]', 'level_4 [V]')
    """
    if owners(controller.law.parameters, "start_level"):
        return [_stages(controller, process)]
    outputs = [process.signal(name) for name in controller.manipulated]
    measured = [process.signal(name) for name in controller.measurements]
    followed = [process.signal(name) for name in controller.setpoints]
    estimated = _estimates(controller, process)
    state = estimated or measured
    memory = [
        Signal(entry.name, entry.unit)
        for entry in controller.law.state
        if isinstance(entry, Signal) and entry.owner == "memory"
    ]
    grids = []
    for stem, title, rows, columns in (
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
    ):
        grid = _matrix(stem, title, rows, columns, controller)
        if grid is not None:
            grids.append(grid)
    return grids


def law_facts(controller: Controller, process: Process) -> list[Table]:
    """Return operating point, limits and anti-windup of a controller that is no scheme of blocks.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> facts = law_facts(cl.design.lqi(plant), plant.process)
    >>> [part.title for part in facts]
    ['Operating point', 'Output pump_1', 'Output pump_2']
    """
    if controller.law.blocks:
        return []
    values, found = controller.values, []
    references = tuple(
        (f"{name}°", quantity_text(process.signal(name), values[key], DIGITS))
        for name in controller.measurements
        if (key := path(name, "reference")) in values
    )
    if references:
        found.append(facts_table("Operating point", references))
    common = tuple(
        (what, text(values[name]))
        for name, what, text in (
            ("alternation", "the duty changes", lambda v: "after each run" if v else "never"),
            ("shortest_rest", "shortest rest of a pump", setting_time),
        )
        if name in values
    )
    if common:
        found.append(facts_table("Pumps", common))
    return found + [
        facts_table(f"Output {name}", _output(process.signal(name), controller))
        for name in controller.manipulated
    ]


def _output(signal: Signal, controller: Controller) -> list[tuple[str, str]]:
    values = controller.values
    facts = []
    for name, what in (
        ("bias", f"{signal.name}°, at rest"),
        ("running_value", "while it runs"),
        ("stopped_value", "while it stands"),
    ):
        if (key := path(signal, name)) in values:
            facts.append((what, quantity_text(signal, values[key], DIGITS)))
    facts += [
        fact
        for fact in output_facts(signal, controller)
        if fact[0] != "output at rest" or path(signal, "bias") not in values
    ]
    for name, what in (("tracking_time", "tracking time"), ("fading_time", "fading time")):
        if (key := path(signal, name)) in values:
            facts.append((what, setting_time(values[key])))
    if (key := path(signal, "in_service")) in values:
        facts.append(("in service", "yes" if values[key] else "no"))
    return facts


def _estimates(controller: Controller, process: Process) -> list[Signal]:
    """Return the quantities that an observer estimates."""
    return [
        known_signal(process, Signal(state.owner, state.unit))
        for state in map(signal_of, controller.law.state)
        if state.part == "estimate"
    ]


def _matrix(
    stem: str,
    title: str,
    rows: Sequence[Signal],
    columns: Sequence[Signal],
    controller: Controller,
) -> Table | None:
    values = controller.values
    names = [[path(path(row, stem), column.name) for column in columns] for row in rows]
    if not any(name in values for of_row in names for name in of_row):
        return None
    gains = np.array([[values.get(name, 0.0) for name in of_row] for of_row in names])
    shown = np.outer([display_factor(s) for s in rows], [1.0 / display_factor(s) for s in columns])
    shown *= settled_gains(gains, rows, columns)
    body = [
        (_named(row), *(number_text(gain, DIGITS) for gain in of_row))
        for row, of_row in zip(rows, shown.tolist(), strict=True)
    ]
    return Table(title, (title, *(_named(column) for column in columns)), tuple(body))


def _named(signal: Signal) -> str:
    unit = unit_text(signal.shown_unit)
    return f"{signal.name} [{unit}]" if unit else signal.name


def _stages(controller: Controller, process: Process) -> Table:
    level, values = process.signal(controller.measurements[0]), controller.values
    rows = []
    for number, stage in enumerate(owners(controller.law.parameters, "start_level"), start=1):
        start, stop = (
            level_words(process, level, values[path(stage, f"{what}_level")])
            for what in ("start", "stop")
        )
        rows.append((f"stage {number}: {number} running", start, stop))
    title = f"Levels ({level.name})"
    return Table(title, (title, "starts at", "stops at"), tuple(rows))
