"""What a proof of a study is about: every controller that can be exported, and the process."""

from __future__ import annotations

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.deploy.exportable import exportable, process_origin
from clepsydra.deploy.proof.item import ProofItem, process_item
from clepsydra.deploy.tagged import tagged_point
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.result import StudyResult


def proof_items(study: StudyResult, settings: PlantShell | None = None) -> list[ProofItem]:
    """Return the controllers of a study in the order of its ranking, then the process.

    A controller that cannot be exported is an item without a program that says why.

    Parameters
    ----------
    study : StudyResult
    settings : PlantShell, optional
        Of the plant shell, as in the export that is to be proved.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)], duration="1 min")
    >>> [item.name for item in proof_items(result)]
    ['PI, SIMC', 'Three coupled tanks']
    """
    point = study.analysis.operating_point
    controllers = [candidate.controller for candidate in study.ranking]
    items = [controller_item(each, point, study.scenario, settings) for each in controllers]
    return [*items, process_item_of(point)]


def process_item_of(point: OperatingPoint) -> ProofItem:
    """Return the item of a process with where its numbers come from."""
    return process_item(tagged_point(point), process_origin(point))


def controller_item(
    controller: Controller,
    point: OperatingPoint,
    scenario: Scenario,
    settings: PlantShell | None,
) -> ProofItem:
    """Return the item of a controller; without a program, and why, if it cannot be exported."""
    period = point.process.sampling_period
    try:
        ready = exportable(controller, point, settings)
    except InputError as refusal:
        return ProofItem(controller.name, period, refusal=str(refusal), controller=controller)
    return ProofItem(
        controller.name,
        period,
        ready.program,
        origin=ready.origin,
        controller=ready.controller,
        point=point,
        scenario=scenario,
        program_in_si=ready.program_in_si,
    )
