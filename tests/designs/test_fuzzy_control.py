"""Fuzzy PI control by the standard table, for every process of the catalogue."""

import functools
import tomllib

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import NotApplicable
from clepsydra.designs.fuzzy_control import (
    SETS,
    design_fuzzy_pi,
    slopes_at_rest,
    standard_rules,
)
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.simc import design_simc
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.loop import Loop
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names


@functools.cache
def analysed(name):
    return cl.load(name).analysis


def every_process():
    for name in catalogue_names():
        with catalogue_file(name).open("rb") as file:
            variants = tomllib.load(file).get("variants", {})
        yield from (f"{name}:{variant}" for variant in variants) if variants else (name,)


def test_the_rule_for_two_sets_is_their_sum():
    numbers = dict(zip(SETS, (-2, -1, 0, 1, 2), strict=True))
    rules = standard_rules("e", "de", "u")
    assert len(rules) == 25
    for rule in rules:
        given = [numbers[part.set] for part in rule.condition.parts]
        assert numbers[rule.conclusions[0].set] == max(-2, min(2, sum(given)))


@pytest.fixture(scope="module")
def surface():
    """Return f(errors, changes) as shares, read off the law of one loop: du/dt = g f."""
    controller = design_fuzzy_pi(analysed("three-tanks").model)
    law, (y,), (u,) = controller.law, controller.measurements, controller.manipulated
    values = controller.values | {f"{u}.low_limit": -1e6, f"{u}.high_limit": 1e6}
    parameters = [values[parameter.name] for parameter in law.parameters]

    def found(errors, changes):
        level = {  # of zero, which was another a second ago
            "mode": 1.0,
            "good": 1.0,
            "time_step": 1.0,
            "sp": errors / values[f"{y}.error.gain"],
            "filtered": -changes / values[f"{y}.change.gain"],
        }
        state, inputs = (
            np.stack([np.broadcast_to(level.get(s.part, 0.0), errors.shape) for s in signals])
            for signals in (law.state, law.inputs)
        )
        _, outputs, _ = law.function(state, inputs, np.array(parameters))
        return np.array(outputs)[0] / values[f"{u}.output_gain"]

    return found


def test_the_surface_is_odd_and_rises_with_both_inputs(surface):
    grid = np.linspace(-1, 1, 21)
    errors, changes = np.meshgrid(grid, grid, indexing="ij")
    values = surface(errors.ravel(), changes.ravel()).reshape(21, 21)
    np.testing.assert_allclose(values, -values[::-1, ::-1], atol=1e-14)
    np.testing.assert_allclose(values, values.T, atol=1e-14)
    assert values[-1, 10] > 0.8 and values[-1, 0] == pytest.approx(0.0, abs=1e-14)
    # Clipped sets are no straight lines: between two peaks the surface may sag by a tenth.
    assert np.all(np.diff(values, axis=0) > -0.1)


@pytest.mark.parametrize("way", [1e-4, 1e-5])
def test_the_slopes_at_rest_are_difference_quotients(surface, way):
    low, high = surface(np.array([-way, way]), np.zeros(2))
    assert slopes_at_rest()[0] == pytest.approx((high - low) / (2 * way), rel=1e-3)
    assert slopes_at_rest()[0] == pytest.approx(slopes_at_rest()[1], rel=1e-12)


def test_at_rest_it_is_the_linear_controller():
    """The sampled loops of both have nearly one sensitivity peak; their gains are the same."""
    analysis = analysed("quadruple-tank")
    fuzzy = design_fuzzy_pi(analysis.model, analysis.pairing)
    linear = design_simc(analysis.model, analysis.pairing)
    s_e, s_c = slopes_at_rest()
    v, w = fuzzy.values, linear.values
    for i in (1, 2):
        gain, time = w[f"level_{i}.proportional_gain"], w[f"level_{i}.integral_time"]
        output_gain = v[f"pump_{i}.output_gain"]
        assert -output_gain * s_c * v[f"level_{i}.change.gain"] == pytest.approx(gain)
        assert output_gain * s_e * v[f"level_{i}.error.gain"] == pytest.approx(gain / time)
    peaks = [sampled_loop(c, analysis.model).maximum_sensitivity for c in (fuzzy, linear)]
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)


@pytest.mark.sampled
@pytest.mark.parametrize("name", list(every_process()))
def test_it_holds_every_process_or_says_why_not(name):
    analysis = analysed(name)
    try:
        controller = design_fuzzy_pi(analysis.model, analysis.pairing)
    except NotApplicable as refusal:
        with pytest.raises(NotApplicable):
            design_simc(analysis.model, analysis.pairing)
        assert refusal.method == "fuzzy PI"
        return
    scenario = default_scenario(analysis.model)
    run = Loop(controller, analysis.model).run(scenario)
    process = analysis.operating_point.process
    step = next(
        s for s in scenario.segments if s.kind == "setpoint" and s.signal in controller.setpoints
    )
    place = process.controlled.index(step.signal)
    error = scenario.setpoints[:, place] - run.true_measurement(step.signal)
    first, last = (int(t / scenario.sampling_period) for t in (step.start, step.stop))
    assert abs(error[first]) > 0.9 * abs(step.size)
    assert abs(error[last - 1]) < 0.35 * abs(step.size)
    assert all(np.isfinite(run.values[name]).all() for name in controller.manipulated)


def test_a_share_that_is_none_is_refused():
    analysis = analysed("quadruple-tank")
    with refused(place="fuzzy PI, largest_error", value=-1):
        design_fuzzy_pi(analysis.model, analysis.pairing, largest_error=-1)
