"""WebAssembly of every process, variant and example, with every kind of law that applies there.

Plants of tests are among them: pumps before valves, delays, late sensors, odd vessels and alarms.

Process, exported controllers and closed loops each run in Wasmtime and natively with nothing fused;
every output of every sample and the last state are equal in every bit.
"""

import runpy
from collections.abc import Iterator
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from hosted_runs import assert_same
from plants import every_variant, plant
from tools import need, need_compiler

import clepsydra as cl
from clepsydra import NotApplicable, PythonLaw
from clepsydra.controllers.controller import Controller
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.exported_alarms import exportable_alarms
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.program import Program
from clepsydra.studies.designs import DESIGNS

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
PLANTS = Path(__file__).parents[1] / "whole_plants"
HOTWELL = EXAMPLES / "hotwell.toml"
SUBJECTS = [
    *every_variant(),
    *(path for folder in (EXAMPLES, PLANTS) for path in sorted(folder.glob("*.toml"))),
    f"{HOTWELL}:open-line",
    f"{PLANTS / 'pumping-station.toml'}:unlike",
]
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
SCANS = 2_000
#: What takes as long as all others together, and is the same routine for every process: of one.
LONG = {"MPC": "quadruple-tank"}
every_subject = pytest.mark.parametrize(
    "subject", SUBJECTS, ids=lambda subject: str(subject).rpartition("/")[2]
)


@pytest.fixture(autouse=True)
def _tools():
    need("wasmtime")


def laws_of(subject) -> Iterator[Controller]:
    """Yield a controller of each kind of law that applies to a process."""
    seen = set()
    for name, design in DESIGNS.items():
        if LONG.get(name, subject) != subject:
            continue
        try:
            controller = design(plant(subject).analysis)
        except NotApplicable:
            continue
        kind = controller.family, controller.law.name
        if kind not in seen:
            yield controller
        seen.add(kind)


def check_scans(program: Program, period: float, *, broken: bool) -> None:
    scans = random_scans(program, SCANS, 5, period, broken=broken)
    given = {signal.name: scans[signal.name] for signal in program.inputs}
    assert_same(program, SCANS, inputs=given)


def check_process(its: cl.Plant) -> None:
    check_scans(process_program(its.point), its.process.sampling_period, broken=False)


def check_controller(controller: Controller, its: cl.Plant) -> None:
    """As it is exported, with everything at its inputs that may go wrong."""
    program = exportable(controller, its.point).program
    check_scans(program, its.process.sampling_period, broken=True)


def check_loop(controller: Controller, its: cl.Plant) -> None:
    """In the scenario that a study runs by itself."""
    loop, scenario = Loop(controller, its.linear), default_scenario(its.linear)
    given = loop.inputs_of(scenario)
    fixed = {name: value for name, value in loop.at_rest().items() if name not in given}
    assert_same(
        closed_loop(its.process, controller, substeps=loop.substeps, constant=fixed),
        scenario.samples,
        inputs=given,
        state=loop.initial_state(),
        parameters=loop.law_parameters(),
    )


@every_subject
@pytest.mark.sampled
def test_the_process(subject):
    check_process(plant(subject))


@pytest.mark.parametrize("alarmed", [HOTWELL, PLANTS / "storm-basin.toml"])
def test_its_alarms(alarmed):
    its = plant(alarmed)
    alarms = exportable_alarms(its.point)
    check_scans(alarms.program, its.process.sampling_period, broken=True)


@every_subject
@pytest.mark.sampled
def test_its_controllers_and_closed_loops(subject):
    checked = 0
    for controller in laws_of(subject):
        check_controller(controller, plant(subject))
        check_loop(controller, plant(subject))
        checked += 1
    assert checked


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
@pytest.mark.thorough
def test_what_a_script_makes(script, tmp_path, monkeypatch):
    """Its plants and its controllers, but for those with a law in Python, which has no program."""
    need_compiler()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    made = runpy.run_path(str(script)).values()
    plt.close("all")
    things = [each for thing in made for each in parts_of(thing)]
    plants = [each for each in things if isinstance(each, cl.Plant)]
    assert plants
    for each in plants:
        check_process(each)
    for each in things:
        if isinstance(each, cl.Controller) and not isinstance(each.law, PythonLaw):
            check_controller(each, each.plant)
            check_loop(each, each.plant)


def parts_of(thing) -> list:
    if isinstance(thing, dict):
        return list(thing.values())
    return list(thing) if isinstance(thing, (list, tuple)) else [thing]
