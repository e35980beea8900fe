"""Step halving by one kernel, which is told how many steps a run takes."""

from pathlib import Path

import numpy as np
import pytest
from random_plants import random_plant

import clepsydra as cl
from clepsydra.loop import loop as closed
from clepsydra.loop import open_loop
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.open_loop_plan import plan_simulation
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


@pytest.mark.parametrize(("name", "kernels"), [("quadruple-tank", 1), (str(DELAYED), 3)])
def test_one_kernel_makes_all_runs_where_there_is_no_delay(name, kernels, monkeypatch):
    made = []

    class Counted(cl.Kernel):
        def __init__(self, program, **options):
            made.append(program)
            super().__init__(program, **options)

    monkeypatch.setattr(closed, "Kernel", Counted)
    monkeypatch.setattr(open_loop, "Kernel", Counted)
    plant = cl.load(name)
    loop = closed.Loop(cl.design.simc(plant), plant.linear)
    loop.run_checked(default_scenario(plant.linear), 4)
    assert len(made) == kernels
    run = cl.simulate(plant, None, duration=f"{60 * plant.process.sampling_period} s")
    assert len(made) == 2 * kernels and run.substeps == 4 * loop.substeps
