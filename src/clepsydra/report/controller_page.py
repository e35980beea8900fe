"""What the report shows of one controller."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.base.errors import InputError
from clepsydra.base.section import Table
from clepsydra.base.signal import path
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.signals import owners
from clepsydra.program.called_blocks import without_untold
from clepsydra.program.owned_state import with_owned_state
from clepsydra.report.controller_tables import ParameterTable, parameter_tables, status_words
from clepsydra.report.drawing.block_picture import program_svg
from clepsydra.report.facts import Facts, range_text
from clepsydra.report.inner_setpoint_curves import with_inner_panels
from clepsydra.report.law_tables import law_facts, law_grids, law_words
from clepsydra.report.loop_picture import loop_svg
from clepsydra.report.margin_tables import margin_grid
from clepsydra.report.panels import all_panels
from clepsydra.report.pid_tables import loop_settings
from clepsydra.report.quantities import quantity_text
from clepsydra.report.scheme_tables import scheme_blocks
from clepsydra.report.score_tables import ScoreTable, score_tables, standing_word
from clepsydra.report.trend_svg import trend_svg
from clepsydra.report.tuning_picture import tuning_svg
from clepsydra.report.tuning_tables import tuning_grid
from clepsydra.studies.result import Candidate, StudyResult

#: So many controllers, from the first of the ranking on, show the blocks that they are made of.
_WITH_BLOCKS = 3


@dataclass(frozen=True)
class ControllerPage:
    """The page of one controller, as its template shows it.

    Parameters
    ----------
    candidate : Candidate
    standing : str
        In a word.
    law : list of str
        What it does in automatic.
    facts : list of Facts
        What is to be set, part by part.
    grids : list of Table
        Its matrices or levels.
    margins, tuning : Table or None
    parameters : list of ParameterTable
        Of the step law, in SI.
    scores : list of ScoreTable
    status : list of str
    picture, loop_picture, tuning_picture, blocks_picture : str
        SVG; empty for none.

    Examples
    --------
    See `controller_page`.
    """

    candidate: Candidate
    standing: str
    law: list[str]
    facts: list[Facts]
    grids: list[Table]
    margins: Table | None
    tuning: Table | None
    parameters: list[ParameterTable]
    scores: list[ScoreTable]
    status: list[str]
    picture: str
    loop_picture: str
    tuning_picture: str
    blocks_picture: str


def controller_page(result: StudyResult, place: int) -> ControllerPage:
    """Return what the report shows of the controller at a place of the ranking.

    Parameters
    ----------
    result : StudyResult
    place : int
        From 0.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> page = controller_page(cl.study(plant, [cl.design.simc(plant)]), 0)
    >>> page.standing, page.picture[:4]
    ('robust', '<svg')
    """
    candidate, process = result.ranking[place], result.process
    controller, name = candidate.controller, candidate.controller.title
    response, tuning = candidate.response, candidate.tuning
    number = place + 1
    title = f"Levels, manipulated variables and disturbances under {name}"
    panels = with_inner_panels(all_panels(candidate.run), candidate.run)
    loop_picture, margins = "", None
    if response is not None:
        margins = margin_grid(response)
        loop_picture = loop_svg(response, process, f"Loops of {name}", f"loop{number}")
    front = ""
    if tuning is not None and len(tuning.front.objective):
        front = tuning_svg(tuning, f"Objective against max|S| of {name}", f"front{number}")
    return ControllerPage(
        candidate,
        standing_word(candidate),
        law_words(controller),
        [
            *loop_settings(controller, result.point),
            *scheme_blocks(controller, process),
            *law_facts(controller, process),
            _wiring(controller, result),
        ],
        law_grids(controller, process),
        margins,
        None if tuning is None else tuning_grid(tuning, process, result.scenario.duration),
        parameter_tables(controller),
        score_tables(process, candidate),
        status_words(candidate.run),
        trend_svg(candidate.run, panels, title, f"run{number}"),
        loop_picture,
        front,
        _blocks(result, place),
    )


def _blocks(result: StudyResult, place: int) -> str:
    """Return the picture of the blocks that a plant gets; empty where nothing can be exported."""
    controller = result.ranking[place].controller
    if place >= _WITH_BLOCKS:
        return ""
    try:
        shelled = with_plant_shell(controller, result.scenario.sampling_period)
    except InputError:  # a function in Python, or a law without what the shell needs
        return ""
    title = f"Blocks of {controller.title} in their plant shell"
    program = without_untold(with_owned_state(shelled.program()))
    return program_svg(program, title, f"blocks{place + 1}")


def _wiring(controller: Controller, result: StudyResult) -> Facts:
    """Return what is connected to what, and how often the law runs."""
    signal = result.process.signal
    facts = [("runs every", time_text(result.scenario.sampling_period))]
    law = controller.law
    for part, ports, words, names in (
        ("pv", law.inputs, "", controller.measurements),
        ("sp", law.inputs, "setpoint of ", controller.setpoints),
        ("out", law.outputs, "", controller.manipulated),
    ):
        for owner, name in zip(owners(ports, part), names, strict=True):
            facts.append((path(owner, part), f"{words}{range_text(signal(name))}"))
    for entry in law.inputs:
        if entry.name in controller.free_inputs:
            value = quantity_text(entry, controller.free_inputs[entry.name])
            facts.append((entry.name, f"{value} at rest"))
    return Facts("Wiring", tuple(facts))
