"""The design of model predictive control."""

from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.designs.states.state_controllers import sensitivity_peak

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
#: Multiples of the physical limit, that of decision 0073 and a hundredth.
MULTIPLES = {"quadruple-tank": 1.073, "three-tanks": 1.113, "eight-tanks": 1.055}


@pytest.fixture(scope="module")
def three_tanks():
    plant = cl.load("three-tanks")
    return plant, cl.design.mpc(plant)


def test_no_offset_stays_under_a_load(three_tanks):
    plant, controller = three_tanks
    load = cl.disturbance("inflow_3", "+10 cm^3/s", at="1 s")
    level = cl.simulate(plant, controller, [load], duration="30 min").values["level_3"]
    assert np.max(np.abs(level - level[0])) > 1e-3
    assert level[-1] == pytest.approx(level[0], abs=1e-6)


def test_its_law_is_linear_where_it_oversteps_nothing_as_the_design_took_it(three_tanks):
    plant, controller = three_tanks
    told = float(controller.design.rpartition("sensitivity peak ")[2].rstrip("."))
    assert sensitivity_peak(controller, plant.linear) == pytest.approx(told, abs=5e-3)


def test_it_plans_within_the_rate_of_a_pump(tmp_path):
    catalogued = Path(cl.__file__).parent / "process" / "catalogue" / "quadruple-tank.toml"
    text = catalogued.read_text("utf-8")
    file = tmp_path / "slow-pump.toml"
    file.write_text(text.replace("[pumps.pump_1]", '[pumps.pump_1]\nrate = "0.5 V/s"'), "utf-8")
    plant = cl.load(file)
    controller = cl.design.mpc(plant)
    assert controller.values["pump_1.rate_limit"] == 0.5
    run = cl.simulate(plant, controller, [cl.step("level_1", "+1 V", at="1 s")], duration="60 s")
    moves = np.abs(np.diff(run.values["pump_1"]))
    assert moves.max() == pytest.approx(0.5, abs=1e-6)
    assert np.abs(np.diff(run.values["pump_2"])).max() > 0.5
    assert run.values["level_1"][-1] == pytest.approx(run.values["level_1"][0] + 1.0, abs=0.02)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"moves": 41}, "moves: got 41, expected a"),
        ({"moves": 0}, "moves: got 0, expected a"),
        ({"horizon": "2 s"}, "horizon: got 2 s, expected 5 to 2000 s"),
        ({"horizon": "-2 s"}, "horizon: got '-2 s', expected"),
        ({"measurements": ["level_9"]}, "measurements: got"),
        ({"measurements": ["level_1"]}, "measurements: got"),
        ({"maximum_errors": {"level_3": 0.0}}, "maximum_errors, level_3: got"),
        ({"maximum_moves": {"feed": -1.0}}, "maximum_moves, feed: got"),
        ({"maximum_errors": {"level_7": 1.0}}, "maximum_errors, level_7: got"),
    ],
)
def test_bad_input_is_refused_with_place_and_remedy(three_tanks, given, expected):
    with pytest.raises(cl.InputError) as refusal:
        cl.design.mpc(three_tanks[0], **given)
    assert expected in str(refusal.value)
    assert refusal.value.remedy


def test_more_moves_than_a_controller_solves_are_refused():
    with pytest.raises(cl.InputError, match="at most 20 moves of each of 2 inputs, 40 in all"):
        cl.design.mpc(cl.load("quadruple-tank"), moves=21)


def test_it_runs_on_the_exported_code_as_in_the_simulation(three_tanks, tmp_path):
    plant, controller = three_tanks
    proof = cl.verify(controller, plant, folder=tmp_path, to=["c"])
    assert proof.holds


@pytest.mark.thorough
@pytest.mark.parametrize("name", MULTIPLES)
def test_it_stands_near_the_physical_limit(name):
    plant = cl.load(name)
    study = cl.study(plant, controllers=[cl.design.mpc(plant)]).with_limits()
    (found,) = study.ranking
    assert 0.995 < study.times_limit(found) < MULTIPLES[name]
    assert found.maximum_sensitivity <= 2.0
    assert "rises above" not in found.reason


@pytest.mark.parametrize(
    "name",
    [
        "averaging-tank", "equalisation-tank", "laboratory-four-tanks", "wet-well",
        "quadruple-tank-nonminimum-phase", "laboratory-four-tanks-nonminimum-phase",
        EXAMPLES / "quanser-coupled-tanks.toml", EXAMPLES / "surge-vessel.toml",
    ],
)  # fmt: skip
def test_other_processes_are_controlled_robustly(name):
    plant = cl.load(name)
    controller = cl.design.mpc(plant)
    assert sensitivity_peak(controller, plant.linear) <= 2.0
