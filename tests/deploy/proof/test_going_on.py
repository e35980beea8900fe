"""An earlier row is taken for true only where it would come out the same."""

import dataclasses

import numpy as np
import pytest
from plants import ONE_TANK, designed, plant
from spoilt_programs import (
    FMUS,
    TEXTS,
    dropped,
    item,
    level_control,
    places,
    quick_proof,
    quickly,
    spoilt,
)
from tools import need_compiler, need_grammar, need_importer

from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.fmi import write
from clepsydra.deploy.proof import compiled_c, interpreted_text, job
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.proof import prove
from clepsydra.deploy.proof.run import Run
from clepsydra.loop.default_scenario import default_scenario

C = {("C", "double")}
OF_TEXTS = {(name, "double") for name in TEXTS}
OF_FMUS = {(name, "double") for name in FMUS}
WEB = {("WebAssembly", "double")}
NO_FMUS = ("C", "Structured Text", "WebAssembly", *TEXTS)
SINGLE_C = {("C", "single"), ("Structured Text", "single")}
SINGLE_TEXT = {("Structured Text", "single")}

pytestmark = pytest.mark.thorough


@pytest.fixture(autouse=True)
def _tools():
    need_compiler()
    need_grammar()
    need_importer()


@pytest.fixture
def ran(monkeypatch):
    """Targets that run, by name and precision; those that are remembered do not."""
    found = set()
    row = Run.row

    def watched(run, *more):
        found.add((run.name, run.precision))
        return row(run, *more)

    monkeypatch.setattr(Run, "row", watched)
    return found


def broken(printer):
    place = places(level_control(), "add")[-1]
    return lambda program, **more: printer(spoilt(program, place, dropped), **more)


@pytest.mark.parametrize(
    ("module", "name", "without", "again", "wrong"),
    [
        (compiled_c, "print_c", FMUS, C | SINGLE_C, C | SINGLE_C),
        (
            interpreted_text,
            "print_structured_text",
            FMUS,
            OF_TEXTS | SINGLE_TEXT,
            OF_TEXTS | SINGLE_TEXT,
        ),
        (write, "print_c", NO_FMUS, OF_FMUS, OF_FMUS),
    ],
    ids=["C", "Structured Text", "FMU"],
)
def test_a_printer_that_broke_since_is_found_out(
    module, name, without, again, wrong, monkeypatch, tmp_path, ran
):
    assert quick_proof(monkeypatch, without=without, folder=tmp_path).holds
    ran.clear()
    assert quick_proof(monkeypatch, without=without, folder=tmp_path).holds and not ran
    monkeypatch.setattr(module, name, broken(getattr(module, name)))
    proof = quick_proof(monkeypatch, without=without, folder=tmp_path)
    assert ran == again
    assert {(row.target, row.precision) for row in proof.failures} == wrong


def test_a_comment_that_changed_is_another_text(monkeypatch, tmp_path, ran):
    quick_proof(monkeypatch, without=FMUS, folder=tmp_path)
    printed = interpreted_text.print_structured_text
    monkeypatch.setattr(
        interpreted_text,
        "print_structured_text",
        lambda program, **more: printed(program, **more) + "\n(* printed anew *)\n",
    )
    ran.clear()
    assert quick_proof(monkeypatch, without=FMUS, folder=tmp_path).holds
    assert ran == (OF_TEXTS | SINGLE_TEXT)


def test_a_part_of_an_fmu_that_changed_is_another_text(monkeypatch, tmp_path, ran):
    from clepsydra.deploy.fmi import write

    quick_proof(monkeypatch, without=NO_FMUS, folder=tmp_path)
    page = write.documentation_page
    monkeypatch.setattr(write, "documentation_page", lambda model: page(model) + "<!-- -->")
    ran.clear()
    proof = quick_proof(monkeypatch, without=NO_FMUS, folder=tmp_path)
    assert proof.holds and ran == OF_FMUS


def test_an_engine_that_broke_since_is_found_out(monkeypatch, tmp_path, ran):
    assert quick_proof(monkeypatch, without=FMUS[1:], folder=tmp_path).holds
    run = job.engine_run

    def spoilt_run(program, inputs, **more):
        return run(spoilt(program, places(program, "add")[-1], dropped), inputs, **more)

    monkeypatch.setattr(job, "engine_run", spoilt_run)
    ran.clear()
    proof = quick_proof(monkeypatch, without=FMUS[1:], folder=tmp_path)
    of_engine = C | OF_TEXTS | WEB | {(FMUS[0], "double"), ("C", "single")}
    assert {(row.target, row.precision) for row in proof.failures} == of_engine
    assert ran == of_engine | SINGLE_C


def test_another_sampling_period_is_another_proof(monkeypatch, tmp_path, ran):
    quickly(monkeypatch, without=FMUS)
    for period in (1.0, 0.1):
        ran.clear()
        timed = dataclasses.replace(item(), sampling_period=period)
        assert prove([timed], scans=1000, folder=tmp_path).holds
        assert ran == C | OF_TEXTS | WEB | SINGLE_C


def loop_item() -> ProofItem:
    controller, tanks = designed("simc", ONE_TANK), plant(ONE_TANK)
    point = tanks.point
    ready = exportable(controller, point)
    return ProofItem(
        controller.name, point.process.sampling_period, ready.program, origin=ready.origin,
        controller=ready.controller, point=point, scenario=default_scenario(tanks.linear),
    )  # fmt: skip


def with_larger_steps(whole: ProofItem) -> ProofItem:
    scenario = whole.scenario
    setpoints = np.array(scenario.setpoints)
    setpoints[len(setpoints) // 2 :] += 0.01
    return dataclasses.replace(whole, scenario=dataclasses.replace(scenario, setpoints=setpoints))


def elsewhere(whole: ProofItem) -> ProofItem:
    point = dataclasses.replace(whole.point, state=whole.point.state * 1.05)
    return dataclasses.replace(whole, point=point)


def with_another_tank(whole: ProofItem) -> ProofItem:
    process = whole.point.process
    first, *rest = process.parameters
    parameters = (dataclasses.replace(first, initial=first.initial * 1.02), *rest)
    process = dataclasses.replace(process, parameters=parameters)
    return dataclasses.replace(whole, point=dataclasses.replace(whole.point, process=process))


@pytest.mark.parametrize("changed", [with_larger_steps, elsewhere, with_another_tank])
def test_scores_of_another_loop_are_run_again(changed, monkeypatch, tmp_path, ran):
    """Scenario, process and operating point belong to the scores, and to nothing else."""
    quickly(monkeypatch, without=[*FMUS, *TEXTS, "Structured Text", "WebAssembly"])
    whole = loop_item()
    first = prove([whole], scans=1000, folder=tmp_path)
    assert ran == {("C", "double"), ("C", "single")}
    ran.clear()
    assert prove([whole], scans=1000, folder=tmp_path).rows == first.rows and not ran
    second = prove([changed(whole)], scans=1000, folder=tmp_path)
    assert ran == {("C", "single")} and second.rows[0] == first.rows[0]
    fresh = prove([changed(whole)], scans=1000)
    assert second.rows[1].scores == fresh.rows[1].scores != first.rows[1].scores
