"""What the report tells of one controller when it is asked: why, settings, margins, scores."""

from __future__ import annotations

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.signals import owners
from clepsydra.program.called_blocks import without_untold
from clepsydra.program.owned_state import with_owned_state
from clepsydra.report.analysis_tables import margin_grid
from clepsydra.report.drawing.block_picture import program_svg
from clepsydra.report.facts import facts_table
from clepsydra.report.law_tables import (
    law_facts,
    law_grids,
    law_words,
    parameter_tables,
    status_words,
)
from clepsydra.report.pid_tables import loop_settings
from clepsydra.report.quantities import number_text, quantity_text
from clepsydra.report.scheme_tables import scheme_blocks
from clepsydra.report.score_tables import score_tables, tuning_grid
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.tuning.result import TuningResult

#: So many points of a front are listed at most.
_FRONT = 8

_Part = Line | Table | Picture | Section


def controller_section(
    result: StudyResult, candidate: Candidate, *, with_blocks: bool = False
) -> Section:
    """Return what the report tells of a controller of its ranking, folded.

    Parameters
    ----------
    result : StudyResult
    candidate : Candidate
    with_blocks : bool
        Whether with a picture of the blocks that are exported.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> section = controller_section(result, result.ranking[0])
    >>> section.title, section.parts[0].text[:6]
    ('1. PI, SIMC', 'Robust')
    """
    controller = candidate.controller
    parts: list[_Part] = [
        Line(candidate.reason),
        *marked(Mark.WATCH, candidate.warnings),
        Line(controller.design),
        *(Line(words) for words in (*controller.notes, *law_words(controller))),
        Section("Settings", (*_settings(controller, result),)),
        Section("How robust it is", _robustness(candidate)),
        Section("How it behaved", _behaviour(result, candidate)),
    ]
    if with_blocks and (picture := _blocks(result, candidate)):
        parts.append(Section("The blocks of its export", (picture,), folded=True))
    return Section(f"{candidate.rank}. {controller.title}", tuple(parts), folded=True)


def _settings(controller: Controller, result: StudyResult) -> list[Table]:
    process = result.process
    grids = law_grids(controller, process)
    # What is told by the settings of loops or by matrices is not told again as parameters.
    rest = [] if grids or controller.law.blocks else parameter_tables(controller)
    return [
        *loop_settings(controller, result.point),
        *scheme_blocks(controller, process),
        *law_facts(controller, process),
        *grids,
        *rest,
        _wiring(controller),
    ]


def _robustness(candidate: Candidate) -> tuple[_Part, ...]:
    response = candidate.response
    if response is None:
        return (Line("There is no linear loop, and so no margin."),)
    return (margin_grid(response),)


def _behaviour(result: StudyResult, candidate: Candidate) -> tuple[_Part, ...]:
    process, tuning = result.process, candidate.tuning
    parts: list[_Part] = [*score_tables(process, candidate)]
    parts += [Line(f"Status of {words}.") for words in status_words(candidate.run)]
    if tuning is not None:
        parts.append(tuning_grid(tuning, process, result.scenario.duration))
        parts += [_front(tuning)] if len(tuning.front.objective) > 1 else []
    return tuple(parts)


def _front(tuning: TuningResult) -> Table:
    """Return what robustness costs: the least objective that was found for each max|S|."""
    front = tuning.front
    chosen = np.linspace(0, len(front.objective) - 1, min(_FRONT, len(front.objective)))
    rows = [
        (number_text(front.sensitivity[place]), number_text(front.objective[place]))
        for place in np.unique(np.rint(chosen).astype(int))
    ]
    return Table("The best found for each max|S|", ("max|S|", "objective"), tuple(rows))


def _blocks(result: StudyResult, candidate: Candidate) -> Picture | None:
    """Return the picture of the blocks that a plant gets; None where nothing can be exported."""
    controller = candidate.controller
    try:
        shelled = with_plant_shell(controller, result.scenario.sampling_period)
    except InputError:  # a function in Python, or a law without what the shell needs
        return None
    title = f"Blocks of {controller.title} in their plant shell"
    program = without_untold(with_owned_state(shelled.program()))
    return Picture(
        program_svg(program, title),
        "Thick wires carry numbers, thin ones truth values; an open circle stands for operations "
        "before a port.",
    )


def _wiring(controller: Controller) -> Table:
    """Return what is connected to what."""
    facts = []
    law = controller.law
    for part, ports, words, names in (
        ("pv", law.inputs, "", controller.measurements),
        ("sp", law.inputs, "setpoint of ", controller.setpoints),
        ("out", law.outputs, "", controller.manipulated),
    ):
        for owner, name in zip(owners(ports, part), names, strict=True):
            facts.append((path(owner, part), f"{words}{name}"))
    for entry in law.inputs:
        if entry.name in controller.free_inputs:
            value = quantity_text(entry, controller.free_inputs[entry.name])
            facts.append((entry.name, f"{value} at rest"))
    return facts_table("Wiring", facts)
