"""The design of the one-step inverse: how near to the limit it is, its margin, its refusals."""

from dataclasses import replace

import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.designs.inverse import design_inverse
from clepsydra.designs.states.state_controllers import sensitivity_peak


def sampled(name, period):
    return cl.Plant(replace(cl.load(name).process, sampling_period=period))


@pytest.mark.parametrize("period", [0.01, 0.1])
@pytest.mark.parametrize(
    ("output", "size"), [("concentration", "+0.25 kmol/m^3"), ("volume", "+0.1 m^3")]
)
def test_a_step_of_the_averaging_tank_comes_to_its_physical_limit(period, output, size):
    plant = sampled("averaging-tank", period)
    step = [cl.step(output, size, at="1 s")]
    controller = cl.design.inverse(plant)
    run = cl.simulate(plant, controller, step, duration="21 s")
    times = cl.limit(plant, step, duration="21 s").times(run)
    # A limit is proved within half a percent.
    assert 1.0 - 0.005 < times < 1.05
    assert sensitivity_peak(controller, plant.linear) < 1.51


@pytest.mark.parametrize(
    ("name", "periods"), [("averaging-tank", 1.725), ("averaging-tank", 5.0), ("quadruple-tank", 3)]
)
def test_the_peak_is_that_of_the_poles_of_its_observer(name, periods):
    """4/(1 + p)² at half the sampling frequency: other tanks and their levels move it by 1 %."""
    plant = cl.load(name)
    pole = periods / (periods + 1.0)
    found = cl.design.inverse(plant, observer_time=periods * plant.process.sampling_period)
    assert sensitivity_peak(found, plant.linear) == pytest.approx(4 / (1 + pole) ** 2, rel=0.01)


def test_states_without_a_sensor_are_estimated():
    """The upper tanks of the quadruple tank: without noise an estimate is what a sensor shows."""
    plant = cl.load("quadruple-tank")
    found = cl.design.inverse(plant, measurements=["level_1", "level_2"])
    assert found.measurements == ("level_1", "level_2")
    step = [cl.step("level_1", "+0.5 V", at="10 s")]
    estimated, measured = (
        cl.simulate(plant, each, step, duration="5 min").true_measurement("level_1")
        for each in (found, cl.design.inverse(plant))
    )
    # One step of Runge-Kutta a sample beside the finer ones of the simulation.
    assert estimated == pytest.approx(measured, abs=1e-6)


def test_an_observer_faster_than_a_sample_is_told_to_be_bold():
    plant = cl.load("averaging-tank")
    found = cl.design.inverse(plant, observer_time="0.01 s")
    assert any("above 2: choose a longer observer time" in note for note in found.notes)


def test_what_counts_more_is_served_first():
    """From 5.9 to 5 kmol/m³ water flows in, which fills the tank: one has to wait."""
    plant = cl.load("averaging-tank")
    events = [cl.step("concentration", "-0.9 kmol/m^3", at="1 s")]
    farthest = {}
    for size in ("0.25 kmol/m^3", "5 kmol/m^3"):
        found = cl.design.inverse(plant, maximum_errors={"concentration": size})
        run = cl.simulate(plant, found, events, duration="10 s")
        farthest[size] = max(abs(run.true_measurement("volume") - 2.0))
    assert farthest["0.25 kmol/m^3"] > 0.2
    assert farthest["5 kmol/m^3"] < 1e-6


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("three-tanks", "level_3 answers to the inputs only by its derivative of order 3"),
        ("wet-well", "level answers to the inputs only by its derivative of order 2"),
        ("eight-tanks", "at most 4 differentiations until an input shows"),
        ("quadruple-tank-nonminimum-phase", "tank_3.level and tank_4.level run away"),
        ("averaging-tank:all-inputs", "it takes as many inputs as controlled outputs"),
    ],
)
def test_the_reason_where_there_is_no_inverse_within_a_sample(name, reason):
    with pytest.raises(NotApplicable, match=reason):
        cl.design.inverse(cl.load(name))


def test_inputs_that_do_not_move_an_output_are_refused():
    """What flows in is as concentrated as the tank: neither flow moves that at rest."""
    whole = cl.load("averaging-tank:all-inputs").linear
    flows = whole.select(("concentration", "volume"), ("inflow", "outflow"))
    with pytest.raises(NotApplicable, match="an input that moves it"):
        design_inverse(flows)


def test_mistakes_in_a_call():
    plant = cl.load("averaging-tank")
    with refused(place="maximum_errors", value="level"):
        cl.design.inverse(plant, maximum_errors={"level": 1.0})
    with refused(place="maximum_errors, volume", value="0.0 m^3", expected="above 0"):
        cl.design.inverse(plant, maximum_errors={"volume": 0.0})
    with refused(place="measurements", value=["volume"], expected="the controlled measurements"):
        cl.design.inverse(plant, measurements=["volume"])
    with refused(place="observer_time", expected="a time"):
        cl.design.inverse(plant, observer_time="-1 s")
