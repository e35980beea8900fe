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


def controller_section(
    result: StudyResult, candidate: Candidate, *, with_blocks: bool = False
) -> Section:
    """Return what the report tells of a controller of its ranking, folded.

    Parameters
    ----------
    with_blocks : bool
        Whether with a picture of the blocks that are exported.
    """
    controller, process, tuning = candidate.controller, result.process, candidate.tuning
    grids = law_grids(controller, process)
    # What is told by the settings of loops or by matrices is not told again as parameters.
    rest = [] if grids or controller.law.blocks else parameter_tables(controller)
    settings = (
        *loop_settings(controller, result.point),
        *scheme_blocks(controller, process),
        *law_facts(controller, process),
        *grids,
        *rest,
        _wiring(controller),
    )
    robust: Line | Table = Line("There is no linear loop, and so no margin.")
    if candidate.response is not None:
        robust = margin_grid(candidate.response)
    behaved: list[Line | Table] = [*score_tables(process, candidate)]
    behaved += [Line(f"Status of {words}.") for words in status_words(candidate.run)]
    if tuning is not None:
        behaved.append(tuning_grid(tuning, process, result.scenario.duration))
        behaved += [_front(tuning)] if len(tuning.front.objective) > 1 else []
    parts: list[Line | Section] = [
        Line(candidate.reason),
        *marked(Mark.WATCH, candidate.warnings),
        Line(controller.design),
        *(Line(words) for words in (*controller.notes, *law_words(controller))),
        Section("Settings", settings),
        Section("How robust it is", (robust,)),
        Section("How it behaved", tuple(behaved)),
    ]
    if with_blocks and (picture := _blocks(result, candidate)):
        parts.append(Section("The blocks of its export", (picture,), folded=True))
    return Section(f"{candidate.rank}. {controller.title}", tuple(parts), folded=True)


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
    law, free = controller.law, controller.free_inputs
    facts: list[tuple[str, str]] = []
    for part, ports, words, names in (
        ("pv", law.inputs, "", controller.measurements),
        ("sp", law.inputs, "setpoint of ", controller.setpoints),
        ("out", law.outputs, "", controller.manipulated),
    ):
        given = [port for owner in owners(ports, part) if (port := path(owner, part)) not in free]
        facts += zip(given, (f"{words}{name}" for name in names), strict=True)
    for entry in law.inputs:
        if entry.name in free:
            facts.append((entry.name, f"{quantity_text(entry, free[entry.name])} at rest"))
    return facts_table("Wiring", facts)
