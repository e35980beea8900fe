"""Step halving by one kernel, which is told how many steps a run takes."""

from pathlib import Path

import numpy as np
import pytest
from random_plants import random_plant

import clepsydra as cl
from clepsydra.loop import loop as closed
from clepsydra.loop import loop_kernel, open_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.open_loop_plan import plan_simulation
from clepsydra.loop.step_size import TOLERANCE, refined
from clepsydra.process.reader import load_process

HOLD = 200
DELAYED = Path(__file__).parents[1] / "dead-time.toml"


def assert_same_bits(one, other):
    assert one.substeps == other.substeps
    assert one.values.keys() == other.values.keys()
    for name, values in one.values.items():
        assert np.array_equal(values, other.values[name]), name


@pytest.mark.parametrize("drawn", [False, True])
def test_pumps_that_trip_do_so_as_by_a_kernel_of_its_own(drawn, tmp_path):
    path = tmp_path / "plant.toml"
    path.write_text(random_plant(121))
    process = load_process(path if drawn else "laboratory-four-tanks")
    jumps = np.repeat([1.0, 0.2, 0.9, 0.0], HOLD)
    profiles = {u.name: u.low + u.span * jumps for u in process.inputs}
    point = plan_simulation(process, duration="1 h").point
    told = open_loop.simulations(point, profiles, {})
    for substeps in (1, 3, 16):
        run = told(substeps)
        assert len(run.events) > 6
        assert_same_bits(run, open_loop.simulate(point, profiles, substeps=substeps))


@pytest.mark.parametrize("largest", [4, 8])
def test_a_loop_moves_as_by_a_kernel_of_its_own(largest):
    plant = cl.load("quadruple-tank")
    loop = closed.Loop(cl.design.simc(plant), plant.linear)
    scenario = default_scenario(plant.linear)
    run = loop.run_checked(scenario, largest)
    assert run.substeps > loop.substeps
    assert_same_bits(run, loop.run(scenario, substeps=run.substeps))


@pytest.mark.parametrize("name", ["quadruple-tank", "laboratory-four-tanks"])
def test_runs_with_other_steps_side_by_side_are_those_of_kernels_of_their_own(name):
    plant = cl.load(name)
    loop = closed.Loop(cl.design.simc(plant), plant.linear)
    scenario = default_scenario(plant.linear)

    def alone(substeps):
        return loop.run(scenario, substeps=substeps)

    run, estimate = refined(plant.process, alone, loop.substeps, TOLERANCE, 4)
    found = loop.run_checked(scenario, 4)
    assert_same_bits(found, run)
    assert found.error_estimate == estimate > 0.0
    assert found.final_state == run.final_state


def test_controllers_of_one_law_have_a_kernel_in_common():
    plant, other = cl.load("three-tanks"), cl.load("three-tanks")
    controllers = [cl.design.simc(plant), cl.design.lambda_(plant), cl.design.lqi(plant)]

    def kernel(controller, process=plant.process, substeps=1, **constant):
        return loop_kernel.loop_kernel(process, controller, constant, substeps, adjustable=False)

    first = kernel(controllers[0])
    assert kernel(controllers[1]) is first is not kernel(controllers[2])
    assert kernel(cl.design.simc(other), other.process) is not first
    assert kernel(controllers[0], substeps=2) is not first
    assert kernel(controllers[0], inflow_1=1e-5) is not first


@pytest.mark.parametrize(("name", "kernels"), [("quadruple-tank", 1), (str(DELAYED), 3)])
def test_one_kernel_makes_all_runs_where_there_is_no_delay(name, kernels, monkeypatch):
    made = []

    class Counted(cl.Kernel):
        def __init__(self, program, **options):
            made.append(program)
            super().__init__(program, **options)

    monkeypatch.setattr(loop_kernel, "Kernel", Counted)
    monkeypatch.setattr(open_loop, "Kernel", Counted)
    plant = cl.load(name)
    loop = closed.Loop(cl.design.simc(plant), plant.linear)
    loop.run_checked(default_scenario(plant.linear), 4)
    assert len(made) == kernels
    run = cl.simulate(plant, None, duration=f"{60 * plant.process.sampling_period} s")
    assert len(made) == 2 * kernels and run.substeps == 4 * loop.substeps
