"""Scheduled, recomputed and observed designs on every process of the catalogue, or why not."""

import dataclasses
import functools
from importlib import resources

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable, PidForm
from clepsydra.designs.gain_scheduling import design_gain_scheduled_lqi, design_gain_scheduled_pid
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.lqi_extended_kalman import design_lqi_extended_kalman
from clepsydra.designs.operating_plan import model_at
from clepsydra.designs.recomputed_lqi import change_over_ranges, design_recomputed_lqi
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.states.measured_states import with_outputs
from clepsydra.linear.process_equations import process_equations

#: Words of the refusal of each design, in this order; None where it applies.
MORE = "inputs move"
EXPECTED = {
    "averaging-tank": (None, None, None, None),
    "averaging-tank:inflow-constant": (None, None, None, None),
    "averaging-tank:all-inputs": ("leave other", MORE, MORE, MORE),
    "eight-tanks": ("fixed gains do as well", "not measured", "same in every state", None),
    "equalisation-tank": ("fixed gains do", "fixed gains do", "same in every state", None),
    "equalisation-tank:dosing": ("leave other", MORE, MORE, MORE),
    "laboratory-four-tanks": (None, None, None, None),
    "laboratory-four-tanks-nonminimum-phase": (None, None, None, None),
    "quadruple-tank": ("fixed gains do", None, None, None),
    "quadruple-tank-nonminimum-phase": (None, None, None, None),
    "three-tanks": (None, None, None, None),
    "wet-well": (None, "not measured", None, None),
    "wet-well:start-stop": ("leave other", MORE, MORE, MORE),
}
DESIGNS = (
    lambda a: design_gain_scheduled_pid(a.model, a.pairing),
    lambda a: design_gain_scheduled_lqi(a.model),
    lambda a: design_recomputed_lqi(a.model),
    lambda a: design_lqi_extended_kalman(a.model),
)


@functools.cache
def analysed(name):
    return cl.load(name).analysis


#: Those on which several designs apply, each at several points, and the one with many states.
SLOW = {name for name, words in EXPECTED.items() if words.count(None) > 2} | {"eight-tanks"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.thorough if n in SLOW else ()) for n in EXPECTED],
)
def test_each_process_is_designed_for_or_refused_in_words(name):
    analysis = analysed(name)
    for design, words in zip(DESIGNS, EXPECTED[name], strict=True):
        if words is None:
            controller = design(analysis)
            assert controller.design.endswith(".") and controller.setpoints
            assert all(np.isfinite(value) for value in controller.initial_state.values())
        else:
            with pytest.raises(NotApplicable, match=words):
                design(analysis)


def test_dead_time_is_refused_where_the_equations_have_no_state_for_it(tmp_path):
    text = (load_process_text("three-tanks")).replace(
        'destination = "tank_1"', 'destination = "pipe"', 1
    )
    path = tmp_path / "late.toml"
    path.write_text(text + '\n[delays.pipe]\ndestination = "tank_1"\ntime = "20 s"\n')
    analysis = analysed(str(path))
    for design in DESIGNS[2:]:
        with pytest.raises(NotApplicable, match="dead time"):
            design(analysis)
    # PI takes dead time as it is, and its schedule too.
    assert "operating points" in DESIGNS[0](analysis).design


def load_process_text(name):
    return (resources.files("clepsydra.process.catalogue") / f"{name}.toml").read_text("utf-8")


@pytest.fixture(scope="module")
def quadruple():
    return analysed("quadruple-tank-nonminimum-phase")


def test_every_peak_that_is_told_is_that_of_the_loop(quadruple):
    """At each point the plain LQI with the table's gains, by another way through the library."""
    model = quadruple.model
    points = [3.0, 5.0, 8.0]
    controller = design_gain_scheduled_lqi(model, over="level_1", points=points)
    plain = design_lqi(model)
    told = controller.design.split("peaks ")[1].split(", halfway")[0].split(", ")
    for k, (point, words) in enumerate(zip(points, told, strict=True), start=1):
        there = model_at(model, {"level_1": point})
        values = {
            name.removesuffix(f".at.{k}"): value
            for name, value in controller.values.items()
            if name.endswith(f".at.{k}")
        }
        frozen = dataclasses.replace(plain, values={**plain.values, **values})
        peak = sampled_loop(frozen, with_outputs(there, plain.measurements)).maximum_sensitivity
        assert float(words.split(" at ")[0]) == pytest.approx(peak, abs=0.0051)
        assert peak <= 2.0 + 1e-6


def test_a_scheduled_pi_has_the_time_constant_asked_at_every_volume():
    """SIMC of a lag V/f: K = V/(f (τc + θ)) with the gain one of C_in to C."""
    analysis = analysed("averaging-tank")
    controller = design_gain_scheduled_pid(
        analysis.model, analysis.pairing, over="volume", points=[0.5, 1.0, 2.0, 4.0]
    )
    gains = [controller.values[f"concentration.proportional_gain.at.{k}"] for k in (1, 2, 3, 4)]
    assert np.array(gains) / gains[2] == pytest.approx(np.array([0.25, 0.5, 1.0, 2.0]), rel=1e-6)


def test_the_linear_model_of_a_slow_process_changes_by_the_same_share():
    """The areas of all tanks divide all of dx/dt."""
    tanks = cl.load("three-tanks")
    lakes = tanks.with_values({f"tank_{k}.area": "15400 m^2" for k in (1, 2, 3)})
    shares = [change_over_ranges(process_equations(each.linear)) for each in (tanks, lakes)]
    assert shares[1] == pytest.approx(shares[0], rel=1e-9)


@pytest.mark.parametrize("name", ["averaging-tank", "three-tanks", "quadruple-tank"])
def test_recomputed_lqi_starts_with_the_gains_of_lqi(name):
    model = analysed(name).model
    plain, recomputed = design_lqi(model), design_recomputed_lqi(model)
    for u in model.inputs:
        for y in model.outputs:
            gain = f"{u}.integral_gain.{y}"
            found = recomputed.initial_state[gain]
            assert found == pytest.approx(plain.values[gain], rel=1e-8, abs=1e-12), gain


def test_wrong_wishes_are_refused(quadruple):
    model = quadruple.model
    with refused(value="level_9"):
        design_gain_scheduled_pid(model, over="level_9")
    with refused(expected="rising"):
        design_gain_scheduled_pid(model, over="level_1", points=[5.0, 3.0])
    with refused(remedy="range"):
        design_gain_scheduled_lqi(model, over="level_1", points=[5.0, 30.0])
    with refused(place="follows"):
        design_gain_scheduled_lqi(model, over="level_1", points=[5.0, 6.0], follows="level")
    with refused(expected="PI or PID"):
        design_gain_scheduled_pid(model, form=PidForm("P"))
    with refused(place="steps"):
        design_recomputed_lqi(model, steps=0)
    with pytest.raises(NotApplicable, match="no equilibrium"):
        design_gain_scheduled_lqi(model, over="level_1", points=[0.3, 6.0])


def test_points_between_which_no_gain_changes_make_no_schedule():
    plant = cl.load("quadruple-tank")
    with refused(place="gain-scheduled SIMC, points", expected="between which a gain changes"):
        cl.design.gain_scheduled_pid(plant, over="level_1", points=["30 %", "50 %", "60 %"])
