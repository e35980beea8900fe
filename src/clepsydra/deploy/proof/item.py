"""What a proof is about: a program, and where it belongs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.deploy.exportable import exportable, process_origin
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.tagged import tagged_point
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.scenario import Scenario
from clepsydra.program.program import Program


@dataclass(frozen=True, eq=False)
class ProofItem:
    """A controller or a process to be proved, or the reason why there is nothing to prove.

    Parameters
    ----------
    name : str
        What the reader calls it: "PI, SIMC".
    sampling_period : float
        [s]
    program : Program or None
        What is printed; None where it cannot be. Of a process it is its `process_program`, with
        as many steps as `substeps_for` says.
    refusal : str
        Why there is no program.
    kind : {"controller", "process"}
        A process gets scans in which nothing is broken, and FMUs for model exchange too.
    origin : Origin or None
        For the heads and comments of what is printed.
    controller : Controller or None
        Whose program it is, so that its single-precision C can control the process; or which has
        none.
    point : OperatingPoint or None
        Where process or loop start.
    scenario : Scenario or None
        What the loop goes through; the default scenario of the process if omitted.
    program_in_si : Program or None
        What an FMU holds, whose importer converts units by himself; the program if omitted.
    """

    name: str
    sampling_period: float
    program: Program | None = None
    refusal: str = ""
    kind: Literal["controller", "process"] = "controller"
    origin: Origin | None = None
    controller: Controller | None = None
    point: OperatingPoint | None = None
    scenario: Scenario | None = None
    program_in_si: Program | None = None


def controller_item(
    controller: Controller, point: OperatingPoint, scenario: Scenario, settings: PlantShell | None
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


def process_item(point: OperatingPoint, origin: Origin | None = None) -> ProofItem:
    """Return the item of a process that starts at rest."""
    process = point.process
    blank = ProofItem(
        process.title, process.sampling_period, kind="process", origin=origin, point=point
    )
    try:
        return replace(blank, program=process_program(point))
    except InputError as refusal:
        return replace(blank, refusal=str(refusal))


def process_item_of(point: OperatingPoint) -> ProofItem:
    """Return the item of a process with its tags, and with where its numbers come from."""
    return process_item(tagged_point(point), process_origin(point))
