"""Feedback linearisation: what the loop does against the response designed, and its refusals."""

import dataclasses
import functools
import math
from pathlib import Path

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError, NotApplicable
from clepsydra.designs.feedback_linearisation import design_feedback_linearisation
from clepsydra.designs.virtual_settings import VirtualSettings, settings_for, settling_time
from clepsydra.linear.analysis import analyse
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.reader import load_process

FULL = Path(__file__).parents[1] / "controllers" / "full-effects.toml"


@functools.cache
def analysed(name):
    return cl.load(name).analysis


def fast(name, period):
    return dataclasses.replace(load_process(name), sampling_period=period)


def stepped(controller, model, column, size, samples):
    """Run a setpoint step of one output at the first sample."""
    point = model.point
    process, at = point.process, point.as_dict()
    setpoints = np.tile([at[name] for name in process.controlled], (samples, 1))
    setpoints[:, column] += size
    loads = np.tile([at[d.name] for d in process.disturbances], (samples, 1))
    noise = np.zeros((samples, len(process.measurements)))
    period = process.sampling_period
    run = Loop(controller, model).run(Scenario(period, setpoints, loads, noise, (), 1))
    return {name: run.true_measurement(name) - at[name] for name in process.controlled}


@pytest.mark.parametrize(
    ("name", "period", "time", "size"),
    [
        ("quadruple-tank", 0.01, 10.0, 0.5),
        ("three-tanks", 0.02, 20.0, 0.002),
        (FULL, 0.01, 8.0, 0.5),
    ],
    ids=["four-tanks", "three-tanks", "full-effects"],
)
def test_an_output_follows_as_designed_and_the_others_stay(name, period, time, size):
    """y = 1 − Σ (t/τ)^k/k! e^(−t/τ), k < r: r equal lags. Sampling costs about a period."""
    process = fast(name, period)
    model = analyse(process).model
    controller = design_feedback_linearisation(model, closed_loop_time_constant=time)
    degree = 3 if name == "three-tanks" else 1
    for column, output in enumerate(process.controlled):
        found = stepped(controller, model, column, size, round(6.0 * time / period))
        t = np.arange(len(found[output])) * period / time
        lagging = np.exp(-t) * sum(t**k / math.factorial(k) for k in range(degree))
        assert np.max(np.abs(found[output] / size - (1.0 - lagging))) < 3.0 * period / time
        for other in process.controlled:
            if other != output:
                assert np.max(np.abs(found[other])) < 3.0 * period / time * 0.1 * size


def test_loops_that_interact_are_decoupled_only_by_the_law():
    """The same step under the PI controllers of a multiloop design moves the other level."""
    from clepsydra.designs.simc import design_simc

    process = fast(FULL, 0.05)
    analysis = analyse(process)
    plain = design_simc(analysis.model, analysis.pairing, closed_loop_time_constant=8.0)
    found = stepped(plain, analysis.model, 0, 0.5, 960)
    linearised = design_feedback_linearisation(analysis.model, closed_loop_time_constant=8.0)
    decoupled = stepped(linearised, analysis.model, 0, 0.5, 960)
    assert np.max(np.abs(found["level_2"])) > 20.0 * np.max(np.abs(decoupled["level_2"]))


@pytest.mark.parametrize(
    "name", ["quadruple-tank", pytest.param("wet-well", marks=pytest.mark.thorough)]
)
def test_with_an_observer_the_output_follows_too(name):
    """The observer runs the same equations, so that without a load there is nothing to estimate."""
    process = load_process(name)
    model = analyse(process).model
    measurements = ["level_1", "level_2"] if name == "quadruple-tank" else None
    observed = design_feedback_linearisation(model, measurements=measurements)
    assert any(state.endswith(".estimate") for state in observed.initial_state)
    size = 0.02 * process.signal(process.controlled[0]).span
    found = stepped(observed, model, 0, size, 600)[process.controlled[0]]
    assert found[-1] == pytest.approx(size, rel=1e-3)
    assert np.max(found) < 1.02 * size


@pytest.mark.parametrize(
    ("settings", "degree"),
    [
        (VirtualSettings(0.125, 0.004), 1),
        (VirtualSettings(0.2, 0.02, 0.3), 1),
        (settings_for(12.0, 3), 3),
    ],
)
def test_settling_times_are_those_of_scipy(settings, degree):
    from scipy.signal import lti, step

    denominator = [1.0, *reversed(settings.damping), settings.gain, settings.integral_gain]
    numerator = [settings.setpoint_weight * settings.gain, settings.integral_gain]
    time, response = step(lti(numerator, denominator), T=np.linspace(0.0, 400.0, 4001))
    last = time[np.flatnonzero(np.abs(response - 1.0) > 0.02)[-1]]
    assert settling_time(settings, degree) == pytest.approx(last, abs=0.5)


def test_settings_put_every_pole_at_one_place():
    settings = settings_for(7.0, 3)
    polynomial = [1.0, *reversed(settings.damping), settings.gain, settings.integral_gain]
    assert polynomial == pytest.approx(np.poly([-1 / 7.0] * 4), rel=1e-12)


def test_unstable_internal_dynamics_are_refused_and_run_only_when_told_to():
    model = analysed("quadruple-tank-nonminimum-phase").model
    with pytest.raises(NotApplicable, match=r"run away, e times as far every 78\.4 s"):
        design_feedback_linearisation(model)
    controller = design_feedback_linearisation(model, despite_unstable_internal_dynamics=True)
    assert any("Unstable" in note for note in controller.notes)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("averaging-tank", "inputs that act linearly"),
        ("eight-tanks", "at most 4 differentiations"),
        ("laboratory-four-tanks-nonminimum-phase", "run away"),
    ],
)
def test_the_stated_refusals_of_the_catalogue(name, words):
    with pytest.raises(NotApplicable, match=words):
        design_feedback_linearisation(analysed(name).model)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name",
    ["equalisation-tank", "laboratory-four-tanks", "three-tanks", "wet-well",
     "averaging-tank:inflow-constant"],
)  # fmt: skip
def test_it_is_robust_where_it_applies(name):
    from clepsydra.designs.states.state_controllers import sensitivity_peak

    model = analysed(name).model
    assert sensitivity_peak(design_feedback_linearisation(model), model) <= 2.0


PLAIN = [VirtualSettings(0.1, 0.003)] * 2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"settings": [VirtualSettings(0.1, 0.0)] * 2}, "level_1, integral gain: got 0.0"),
        ({"settings": [VirtualSettings(0.1, -0.01)] * 2}, "integral gain"),
        ({"settings": [VirtualSettings(-0.1, 0.01)] * 2}, "comes to rest"),
        ({"settings": PLAIN[:1]}, "2 settings"),
        ({"settings": [VirtualSettings(0.1, 0.003, 1.5)] * 2}, "setpoint weight"),
        ({"settings": [VirtualSettings(0.1, 0.003, 1.0, (1.0,))] * 2}, "its relative degree is 1"),
        ({"closed_loop_time_constant": 0.0}, "above 0 s"),
        ({"settings": PLAIN, "alpha": 9.0}, r"alpha of level_1.*2 to 5 times as fast"),
        ({"settings": PLAIN, "alpha": -1.0}, "above 0 1/s"),
        ({"settings": PLAIN, "alpha": [0.3]}, "2 rates"),
        ({"anti_windup": "strong"}, "anti_windup"),
        ({"measurements": ["level_1", "level_7"]}, "level_7"),
    ],
)  # fmt: skip
def test_wrong_numbers_are_refused_with_place_and_remedy(options, words):
    model = analysed("quadruple-tank").model
    with pytest.raises(InputError, match=words):
        design_feedback_linearisation(model, **options)


def test_alpha_on_the_input_counts_by_the_effect_of_the_input():
    model = analysed("quadruple-tank").model
    of_virtual = design_feedback_linearisation(model, settings=PLAIN)
    of_input = design_feedback_linearisation(model, settings=PLAIN, alpha_on="input")
    # Johansson's γ k/A on sensors of 0.5 V/cm.
    for j, effect in ((1, 0.5 * 0.7 * 3.33 / 28), (2, 0.5 * 0.6 * 3.35 / 32)):
        rate = of_virtual.values[f"level_{j}.saturation_rate"]
        assert of_input.values[f"level_{j}.saturation_feedback"] == pytest.approx(rate * effect)
    # Where each input moves its own output alone, an excess dies away alike in both.
    left = []
    for controller in (of_virtual, of_input):
        given = {"time_step": 1.0, "sp": 10.0, "pv": 5.0, "good": 1.0, "mode": 1.0}
        integrals = [f"level_{j}.virtual_integral" for j in (1, 2)]
        state = controller.initial_state | dict.fromkeys(integrals, 2.0)
        law = controller.law
        following, _, _ = law.function(
            [state[entry.name] for entry in law.state],
            [given.get(signal.part, 0.0) for signal in law.inputs],
            [controller.values[parameter.name] for parameter in law.parameters],
        )
        names = [entry.name for entry in law.state]
        left.append([float(following[names.index(name)]) for name in integrals])
    assert left[1] == pytest.approx(left[0], rel=1e-9)
    assert 1.0 < max(left[0]) < 1.9


@pytest.mark.parametrize("alpha_on", ["virtual", "input"])
@pytest.mark.parametrize("alpha", ["fast", ["fast", 0.1], [0.1], 1e9])
def test_an_alpha_that_is_no_rate_is_refused_in_words(alpha, alpha_on):
    model = analysed("quadruple-tank").model
    with refused(place="alpha"):
        design_feedback_linearisation(model, settings=PLAIN, alpha=alpha, alpha_on=alpha_on)


def test_an_alpha_on_the_input_is_taken_in_its_own_unit():
    model = analysed("quadruple-tank").model
    usual = design_feedback_linearisation(model, settings=PLAIN, alpha_on="input")
    given = [usual.values[f"level_{j}.saturation_feedback"] for j in (1, 2)]
    again = design_feedback_linearisation(model, settings=PLAIN, alpha_on="input", alpha=given)
    assert again.values == pytest.approx(usual.values)


@pytest.mark.parametrize(
    "settings", [[(0.1, 0.01), (0.1, 0.01)], [VirtualSettings("fast", 0.01)] * 2, 0.1]
)
def test_settings_of_another_kind_are_refused_in_words(settings):
    model = analysed("quadruple-tank").model
    with refused(place="settings"):
        design_feedback_linearisation(model, settings=settings)
