"""The response of the sampled loop against closed forms, the state-space loop and fast sampling."""

import math

import numpy as np
import pytest
from flow_cascade import flow_cascade

from clepsydra import PidForm
from clepsydra.linear.linearise import linearise
from clepsydra.studies.file.reader import read_study
from clepsydra.studies.warnings.bandwidth import bandwidth_in, largest_bandwidth
from clepsydra.studies.warnings.channel import Channel
from clepsydra.studies.warnings.loop_response import loop_response
from clepsydra.studies.warnings.margins import margin_warnings

#: Volts of level per second and volt of the pump, of the tank of these tests.
RATE = 0.2


@pytest.mark.parametrize("gain", [0.5, 2.0, 6.0])
def test_margins_of_a_sampled_integrator_are_those_of_its_closed_form(tank, proportional, gain):
    """L = a/(z - 1): gain margin 2/a at π/T, 2 sin(ωc T/2) = a, phase margin 90° - ωc T/2."""
    model = tank().model
    response = loop_response(proportional(model, gain), model)
    a = RATE * gain
    for name in ("level", "pump"):
        channel = response.channels[name]
        half = math.asin(a / 2.0)
        assert channel.gain_margin.value == pytest.approx(2.0 / a, rel=1e-6), name
        assert channel.gain_margin.frequency == pytest.approx(math.pi, rel=1e-12), name
        assert channel.crossovers == pytest.approx([2.0 * half], rel=1e-3), name
        assert channel.phase_margin.value == pytest.approx(math.pi / 2.0 - half, rel=1e-3), name


@pytest.mark.parametrize("gain", [0.5, 2.0, 4.0])
def test_the_bandwidth_of_a_sampled_integrator_is_that_of_its_closed_form(tank, proportional, gain):
    """|z - 1|² = |z - 1 + a|²/2 gives cos(ωT) = (3 - (1-a)²)/(2 + 2a)."""
    model = tank().model
    a = RATE * gain
    cosine = (3.0 - (1.0 - a) ** 2) / (2.0 + 2.0 * a)
    found = bandwidth_in(loop_response(proportional(model, gain), model), np.ones(1))
    assert found == pytest.approx(math.acos(cosine), rel=1e-3)


@pytest.mark.parametrize("case", ["quadruple", "nonminimum"])
def test_the_sensitivity_is_that_of_the_state_space_loop(request, case):
    analysis, controller = request.getfixturevalue(case)
    response = loop_response(controller, analysis.model)
    loop = response.loop
    for k in range(0, len(response.frequencies), 20):
        z = np.exp(1j * response.frequencies[k] * response.period)
        S = loop.C @ np.linalg.solve(z * np.eye(len(loop.A)) - loop.A, loop.B) + loop.D
        np.testing.assert_allclose(response.at_output[k], S, rtol=1e-8, atol=1e-10)
    sizes = np.linalg.norm(response.at_output, 2, axis=(1, 2))
    assert sizes.max() == pytest.approx(loop.maximum_sensitivity, rel=2e-3)
    # L broken at the input and at the output has one determinant of I + L.
    np.testing.assert_allclose(
        np.linalg.det(response.at_input), np.linalg.det(response.at_output), rtol=1e-8
    )


def test_sampled_fast_the_margins_are_those_of_continuous_time(tank, pid):
    """L = 0.2 (s + 1/2)/s², at 1000 samples a second, against its closed form.

    |L| = 1 at ωc² = (0.04 + √(0.04² + 0.04))/2 with a phase of atan(2 ωc) above -180°, and the
    disk margin is the least distance 1/|S - 1/2| = 2 |1 + L|/|1 - L|.
    """
    model = tank(period=0.001).model
    form = PidForm(anti_windup="none")
    controller = pid(model, form, proportional_gain=1.0, integral_time=2.0)
    response = loop_response(controller, model)
    channel = response.channels["level"]
    crossover = math.sqrt((RATE**2 + math.sqrt(RATE**4 + RATE**2)) / 2.0)
    assert channel.crossovers == pytest.approx([crossover], rel=2e-3)
    assert channel.phase_margin.value == pytest.approx(math.atan(2.0 * crossover), rel=2e-3)
    s = 1j * np.geomspace(1e-3, 1e2, 20_001)
    loop = RATE * (s + 0.5) / s**2
    nearest = np.min(2.0 * np.abs((1.0 + loop) / (1.0 - loop)))
    sizes = np.abs(response.at_output[:, 0, 0] - 0.5)
    assert 1.0 / sizes.max() == pytest.approx(nearest, rel=2e-3)


def test_a_long_dead_time_takes_the_sparse_way_to_the_same_response(tank, proportional):
    """80 samples of dead time: L = a z^-80/(z - 1)."""
    channel = '[delays.channel]\ndestination = "tank"\ntime = "80 s"'
    model = tank(destination="channel", more=channel).model
    response = loop_response(proportional(model, 0.05), model)
    assert len(response.loop.A) > 60
    z = np.exp(1j * response.frequencies)
    expected = 0.05 * RATE * z**-80.0 / (z - 1.0)
    np.testing.assert_allclose(response.channels["level"].loop, expected, rtol=1e-7)


def test_a_gain_that_must_not_be_lowered_has_a_margin_below_one():
    """k (s + 1)²/s³ is stable for k above 1/2 and crosses -180° at 1 rad/s."""
    omega = np.geomspace(1e-3, 1e3, 1200)
    channel = Channel(omega, 0.8 * (1j * omega + 1.0) ** 2 / (1j * omega) ** 3)
    assert channel.gain_margin.value == pytest.approx(0.5 / 0.8, rel=1e-3)
    assert channel.gain_margin.frequency == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("zero", [0.3 + 0j, 0.3 + 0.1j, 0.3 + 0.3j, 0.02 + 0.3j])
def test_the_largest_bandwidth_is_where_the_zero_has_taken_53_degrees(zero):
    omega = 1j * largest_bandwidth(zero)
    roots = [zero] if zero.imag == 0.0 else [zero, zero.conjugate()]
    allpass = np.prod([(root - omega) / (root.conjugate() + omega) for root in roots])
    assert -np.angle(allpass) == pytest.approx(2.0 * math.atan(0.5), rel=1e-9)


def test_the_grid_of_frequencies_reaches_the_nyquist_frequency(quadruple):
    analysis, controller = quadruple
    response = loop_response(controller, analysis.model)
    assert response.frequencies[-1] == pytest.approx(math.pi, rel=1e-12)
    assert np.all(np.diff(response.frequencies) > 0.0)
    slowest = np.min(np.abs(analysis.poles))
    assert response.frequencies[0] < slowest


@pytest.mark.parametrize("actions", ["P", "PD"])
def test_a_bias_that_nothing_moves_is_no_mode_of_the_loop(tank, pid, actions):
    """Under proportional control the integral is a constant, and no eigenvalue of one."""
    model = tank().model
    response = loop_response(pid(model, PidForm(actions), proportional_gain=2.0), model)
    assert response.loop.is_stable
    if actions == "P":
        assert response.law.A.shape == (0, 0)
        assert np.linalg.eigvals(response.loop.A) == pytest.approx([1.0 - 2.0 * RATE])


@pytest.fixture
def cascade(tmp_path):
    """Return a function from the gain of a flow loop within a level loop to their response."""

    def make(gain):
        path = tmp_path / "cascade.toml"
        words = {"level_time": "10 min", "flow_gain": gain, "flow_time": "20 s", "high": ""}
        path.write_text(flow_cascade(**words), encoding="utf-8")
        study = read_study(path)
        model = linearise(study.analysis.operating_point)
        return loop_response(study.controllers[0].make(study.analysis, model), model)

    return make


def test_an_inner_loop_is_looked_at_beside_the_outer_one(cascade):
    """With u = C (K (r - y) - f): S at y is (1 + C F)/(1 + L), at f (1 + C K G)/(1 + L).

    L = C F + C K G is the loop at u, so that both together are 1 more than S at u.
    """
    response = cascade("0.4 %/%")
    assert response.outputs == ("level",) and list(response.at_inner) == ["duty_flow"]
    at_level, at_pump = response.at_output[:, 0, 0], response.at_input[:, 0, 0]
    both = at_level + response.at_inner["duty_flow"]
    np.testing.assert_allclose(both, 1.0 + at_pump, rtol=1e-9)
    assert np.max(np.abs(response.at_inner["duty_flow"] - 1.0)) > 0.1
    assert list(response.channels) == ["level", "duty_flow", "duty"]
    assert list(margin_warnings(response)) == []


def test_a_thin_inner_loop_is_told_though_the_outer_one_is_robust(cascade):
    response = cascade("3 %/%")
    assert response.loop.is_stable and response.loop.maximum_sensitivity < 1.1
    name, peak = response.inner_peak
    assert name == "duty_flow" and peak > 3.0
    said = list(margin_warnings(response))
    assert f"max|S| of the inner loop of duty_flow is {peak:.2f}" in said[0]
    assert said[1].startswith("The loop of duty_flow has a gain margin of")
