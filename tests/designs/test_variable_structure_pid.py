"""The design of variable-structure PID: its rule for α, its settings, and what it refuses."""

import functools
import math

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError, PidForm
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.sampled.setpoint_response import settling_times
from clepsydra.designs.saturation_rate import rate_for, times_faster
from clepsydra.designs.simc import design_simc
from clepsydra.designs.variable_structure_pid import design_variable_structure_pid
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.catalogue_names import catalogue_names

JOHANSSON = [PidSettings(3.0, 30.0), PidSettings(2.7, 40.0)]


@functools.cache
def analysed(name):
    return cl.load(name).analysis


@pytest.mark.sampled
@pytest.mark.parametrize("name", catalogue_names())
def test_it_has_a_controller_for_every_process(name):
    analysis = analysed(name)
    controller = design_variable_structure_pid(analysis.model, analysis.pairing)
    plain = design_simc(analysis.model, analysis.pairing, form=PidForm("PI", anti_windup="none"))
    assert controller.initial_state == plain.initial_state
    settled = settling_times(plain, analysis.model)
    for output in controller.setpoints:
        rate = controller.values[f"{output}.saturation_rate"]
        assert times_faster(rate, settled[output]) == pytest.approx(3.0)
        for what in ("proportional_gain", "integral_time"):
            key = f"{output}.{what}"
            # Unrounded here, the gain goes to percent and back once more than the plain one.
            assert controller.values[key] == pytest.approx(plain.values[key], rel=1e-14)


def test_the_rule_makes_an_excess_settle_so_many_times_sooner():
    for factor in (2.0, 5.0):
        rate = rate_for(60.0, factor)
        time = -math.log(0.02) / rate
        assert 60.0 / time == pytest.approx(factor)


@pytest.mark.parametrize("name", ["quadruple-tank", "wet-well", "eight-tanks"])
def test_settling_times_are_those_of_a_small_step(name):
    """The linear response against a run of the process itself, so small that it is linear."""
    analysis = analysed(name)
    model, point = analysis.model, analysis.operating_point
    process, at = point.process, point.as_dict()
    controller = design_simc(model, analysis.pairing)
    expected = settling_times(controller, model)
    for column, output in enumerate(process.controlled):
        samples = round(3.0 * expected[output] / process.sampling_period)
        size = 1e-4 * process.signal(output).span
        setpoints = np.tile([at[each] for each in process.controlled], (samples, 1))
        setpoints[:, column] += size
        loads = np.tile([at[d.name] for d in process.disturbances], (samples, 1))
        noise = np.zeros((samples, len(process.measurements)))
        scenario = Scenario(process.sampling_period, setpoints, loads, noise, (), 1)
        y = Loop(controller, model).run(scenario).true_measurement(output)
        outside = np.flatnonzero(np.abs((y - at[output]) / size - 1.0) > 0.02)
        found = (outside[-1] + 1) * process.sampling_period
        room = 2.0 * process.sampling_period + 0.01 * expected[output]
        assert found == pytest.approx(expected[output], abs=room)


def test_alpha_of_the_user_is_taken_within_the_rule_and_refused_outside():
    analysis = analysed("quadruple-tank")
    given = analysis.model, analysis.pairing
    controller = design_variable_structure_pid(*given, settings=JOHANSSON, alpha=[0.2, 0.15])
    assert controller.values["level_2.saturation_rate"] == 0.15
    for alpha in (0.01, 4.0):
        with refused(remedy="choose α within"):
            design_variable_structure_pid(*given, settings=JOHANSSON, alpha=alpha)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ([PidSettings(3.0), JOHANSSON[1]], r"integral gain K/Ti of level_1 by pump_1: got 0\.0"),
        ([PidSettings(3.0, 0.0), JOHANSSON[1]], r"got nan, expected a number above zero"),
        ([PidSettings(-3.0, 30.0), JOHANSSON[1]], r"got -0\.1, expected a number above zero"),
        (JOHANSSON[:1], "2 settings"),
    ],
)  # fmt: skip
def test_an_integral_gain_that_is_not_above_zero_is_refused(settings, words):
    analysis = analysed("quadruple-tank")
    with pytest.raises(InputError, match=words):
        design_variable_structure_pid(analysis.model, analysis.pairing, settings=settings)


def test_direct_action_needs_a_negative_gain():
    """The basin's level falls when its pump runs faster."""
    analysis = analysed("equalisation-tank")
    given = analysis.model, analysis.pairing
    controller = design_variable_structure_pid(*given, settings=[PidSettings(-3.0, 9000.0)])
    assert controller.values["level.proportional_gain"] == -3.0
    with refused(expected="a number below zero"):
        design_variable_structure_pid(*given, settings=[PidSettings(3.0, 9000.0)])


def test_forms_without_an_integral_are_refused():
    analysis = analysed("quadruple-tank")
    with refused(place="PI"):
        design_variable_structure_pid(analysis.model, analysis.pairing, form=PidForm("P"))


@pytest.mark.parametrize("settings", [[(3.0, 30.0), (2.7, 40.0)], 3.0])
def test_settings_of_another_kind_are_refused_in_words(settings):
    analysis = analysed("quadruple-tank")
    with refused(place="settings"):
        design_variable_structure_pid(analysis.model, analysis.pairing, settings=settings)
