"""A run that goes on where another one ended: two halves are one whole, bit for bit."""

import numpy as np
import pytest
from refusals import refused
from written_plants import plant_of

import clepsydra as cl

HALF = 60
#: A pump that feeds a tank through 24 s of pipe, sampled each 4 s.
LATE = """
name = "late"
sampling_period = "4 s"
controlled = ["level"]
[reservoirs.basin]
[tanks.tank]
area = "28 cm^2"
height = "40 cm"
[orifices.outlet]
source = "tank"
destination = "basin"
area = "0.1 cm^2"
[delays.pipe]
destination = "tank"
time = "24 s"
[pumps.pump]
source = "basin"
destination = "pipe"
gain = "3 cm^3/(s V)"
range = ["0 V", "10 V"]
nominal = "4 V"
[sensors.level]
tank = "tank"
range = ["0 cm", "40 cm"]
"""


@pytest.fixture(scope="module")
def four_tanks():
    return cl.load("quadruple-tank")


def halves(plant, controller, signal, steps, **how):
    """Return a run and the two halves of it, a step and one more behind the middle."""
    period = plant.process.sampling_period
    first, second = (float(each) for each in steps)
    events = [cl.step(signal, to=first, at=3 * period), cl.step(signal, to=second, at=70 * period)]
    length = HALF * period
    whole = cl.simulate(plant, controller, events, duration=2 * length, **how)
    one = cl.simulate(plant, controller, events[:1], duration=length, **how)
    rest = [cl.step(signal, to=first, at=0), cl.step(signal, to=second, at=10 * period)]
    how = {key: value for key, value in how.items() if key == "solver"}
    two = cl.simulate(plant, controller, rest, duration=length, start=one.final_state, **how)
    return whole, one, two


def assert_whole(whole, one, two):
    """Assert it of every trajectory and of what lives at the end."""
    assert whole.substeps == one.substeps == two.substeps
    for name, values in whole.values.items():
        assert np.array_equal(values, np.concatenate([one.values[name], two.values[name]])), name
    last, again = whole.final_state, two.final_state
    assert dict(last) == dict(again) and last.contents == again.contents
    assert last.rings.keys() == again.rings.keys()
    for name, ring in last.rings.items():
        assert np.array_equal(ring, again.rings[name])


@pytest.mark.parametrize("name", ["simc", "lqi_kalman", "glover_mcfarlane", "fuzzy_pi"])
def test_levels_and_controller_go_on(four_tanks, name):
    controller = getattr(cl.design, name)(four_tanks)
    assert_whole(*halves(four_tanks, controller, "level_1", (7.0, 6.5), start="empty"))


def test_the_reference_solver_goes_on(four_tanks):
    pi = cl.design.simc(four_tanks)
    assert_whole(*halves(four_tanks, pi, "level_1", (7.0, 6.5), solver="reference"))


@pytest.mark.parametrize("solver", ["kernel", "reference"])
@pytest.mark.parametrize("name", ["simc", "smith_predictor"])
def test_what_is_in_a_pipe_goes_on(tmp_path, name, solver):
    """The delays of the plant and of the predictor hold a step that has not yet come out."""
    plant = plant_of(tmp_path, LATE)
    controller = getattr(cl.design, name)(plant)
    whole, one, two = halves(plant, controller, "level", (28.0, 24.0), solver=solver)
    assert_whole(whole, one, two)
    assert one.final_state.rings
    # What is in the pipe matters: from the levels alone the same run is another one.
    names = ("tank.level", "pump")
    alone = {name: float(100.0 ** (name != "pump") * one.final_state[name]) for name in names}
    other = cl.simulate(plant, controller, duration="2 min", state=alone, solver=solver)
    assert not np.array_equal(other.values["tank.level"], two.values["tank.level"][:30])


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_what_a_sensor_has_not_told_yet_goes_on(tmp_path, solver):
    """Readings of 20 s, told every 28 s: the halves meet between two reports."""
    late = 'tank = "tank"\ndead_time = "20 s"\nsampling = "28 s"'
    plant = plant_of(tmp_path, LATE, ('tank = "tank"\nrange', f"{late}\nrange"))
    controller = cl.design.simc(plant)
    whole, one, two = halves(plant, controller, "level", (28.0, 24.0), solver=solver)
    assert_whole(whole, one, two)
    told = two.values["level"]
    assert told[0] == one.values["level"][-1] != two.values["tank.level"][0]


def test_a_law_in_python_goes_on(four_tanks):
    def step(state, inputs, parameters, time_step):
        error = inputs["level_1.sp"] - inputs["level_1.pv"]
        integral = state["integral"] + 0.05 * time_step * error
        return {"integral": integral}, {"pump_1.out": 2.0 * error + integral}

    inputs = [cl.Signal(f"level_1.{part}", "V") for part in ("sp", "pv")]
    outputs = [cl.Signal("pump_1.out", "V", low=0.0, high=10.0)]
    state = [cl.Signal("integral", "V", initial=3.0)]
    law = cl.python_law("mine", step, inputs=inputs, outputs=outputs, parameters=[], state=state)
    wires = {"measurements": ["level_1"], "setpoints": ["level_1"], "manipulated": ["pump_1"]}
    controller = cl.design.own(four_tanks, law, **wires)
    assert_whole(*halves(four_tanks, controller, "level_1", (7.0, 6.5)))


def test_another_controller_takes_over_without_a_bump(four_tanks):
    """Where the first stood at last the second begins: its output at what the pump had."""
    first = cl.simulate(
        four_tanks, cl.design.simc(four_tanks), [cl.step("level_1", to="8 V", at=0)], duration=40
    )
    lqi = cl.design.lqi(four_tanks)
    then = cl.simulate(four_tanks, lqi, duration=40, start=first.final_state)
    for name in ("pump_1", "pump_2"):
        assert then.values[name][0] == pytest.approx(first.values[name][-1], abs=1e-9)
    again = cl.simulate(
        four_tanks, cl.design.simc(four_tanks), duration=40, start=first.final_state,
        controller_start="bumpless",
    )  # fmt: skip
    assert again.values["pump_1"][0] == pytest.approx(first.values["pump_1"][-1], abs=1e-9)


def test_what_a_run_leaves_reads_as_a_mapping(four_tanks):
    run = cl.simulate(four_tanks, cl.design.simc(four_tanks), [], duration=10)
    state = run.final_state
    assert {"tank_1.level", "pump_1", "controller.level_1.integral"} <= state.keys()
    assert state["pump_1"] == run.values["pump_1"][-1]
    assert "tank_1.level = 12.263 cm" in str(state)
    with refused(value="tank_1.levle", remedy="'tank_1.level' was meant"):
        state["tank_1.levle"]
    assert "nothing" not in state and state.get("nothing") is None
