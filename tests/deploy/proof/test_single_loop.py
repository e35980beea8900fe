"""A loop that is controlled by compiled C, and what single precision does to its scores."""

import dataclasses

import numpy as np
import pytest
from deployed import CompiledC
from plants import plant

from clepsydra.controllers.controller import Controller
from clepsydra.deploy.proof.compiled_law import compiled_law
from clepsydra.deploy.proof.single_loop import ScoreChange, score_change
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.operation import Operation
from clepsydra.studies.designs import DESIGNS


def controlled_by(controller: Controller, compiled: CompiledC) -> Controller:
    return dataclasses.replace(controller, law=compiled_law(controller.law, compiled))


@pytest.mark.thorough
def test_a_law_with_delay_rings_runs_as_c_in_the_loop(tmp_path):
    analysis = plant("eight-tanks").analysis
    controller = DESIGNS["Smith predictor, PI"](analysis)
    assert any(isinstance(entry, DelayRing) for entry in controller.law.state)
    scenario = default_scenario(analysis.model)
    compiled = CompiledC(controller.program(), tmp_path)
    runs = [
        Loop(each, analysis.model).run(scenario).values
        for each in (controller, controlled_by(controller, compiled))
    ]
    assert all(np.array_equal(runs[0][name], runs[1][name]) for name in runs[0])


@pytest.mark.thorough
def test_single_precision_moves_a_loop_by_its_rounding_and_no_score_that_counts(tmp_path):
    analysis = plant("quadruple-tank").analysis
    controller = DESIGNS["PI, SIMC"](analysis)
    compiled = CompiledC(controller.program(), tmp_path, "single")
    scenario = default_scenario(analysis.model)
    runs = [
        Loop(each, analysis.model).run(scenario)
        for each in (controller, controlled_by(controller, compiled))
    ]
    moved = np.abs(runs[1].values["level_1"] - runs[0].values["level_1"]).max()
    assert 0.0 < moved < 1e-4  # of 10 V, in the noise of the sensor
    change = score_change(controller, analysis.model, compiled, scenario)
    assert change.score and change.change > 0.0 and not change.is_change
    assert change.ranking == pytest.approx(1.0, abs=1e-4)


@pytest.mark.thorough
def test_a_program_that_is_no_more_the_controller_changes_the_scores(tmp_path):
    """The output goes only half of its way in the C: the loop is slower, and its scores worse."""
    analysis = plant("quadruple-tank").analysis
    controller = DESIGNS["PI, SIMC"](analysis)
    program = controller.program()
    block = program.block
    size = 1 + max(operation.target for operation in block.operations())
    place = len(program.state)
    statements = (
        Operation(size, "add", (block.results[place + 2], place - 1)),
        Operation(size + 1, "constant", (), 0.5),
        Operation(size + 2, "multiply", (size, size + 1)),
    )
    assert program.state[-1].name == "pump_2.last_output" and len(program.outputs) == 4
    results = list(block.results)
    results[place + 2], results[place - 1] = size + 2, size + 2
    slow = dataclasses.replace(
        program,
        block=dataclasses.replace(
            block, statements=(*block.statements, *statements), results=tuple(results)
        ),
    )
    change = score_change(controller, analysis.model, CompiledC(slow, tmp_path))
    assert change.is_change and change.ranking > 1.005


@pytest.mark.parametrize(
    ("ranking", "is_change"),
    [(1.0, False), (1.004, False), (0.996, False), (1.006, True), (0.99, True), (np.nan, True)],
)
def test_a_change_is_one_of_the_third_digit(ranking, is_change):
    assert ScoreChange(ranking, "iae[y]", 0.0).is_change is is_change
