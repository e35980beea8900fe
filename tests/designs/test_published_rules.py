"""Tuning rules against the examples of their publications, and experiments in closed form."""

import math

import numpy as np
import pytest

from clepsydra import InputError, NotApplicable, PidForm
from clepsydra.designs.amigo import amigo_settings, design_amigo
from clepsydra.designs.loops.pid_settings import PidSettings, to_series
from clepsydra.designs.models.delayed_lags import DelayedLags, half_rule
from clepsydra.designs.models.reaction_curve import reaction_curve
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.models.ultimate_point import UltimatePoint, ultimate_point
from clepsydra.designs.simc import simc_settings
from clepsydra.designs.tyreus_luyben import design_tyreus_luyben, tyreus_luyben_settings
from clepsydra.designs.ziegler_nichols import (
    design_ziegler_nichols,
    ziegler_nichols_settings,
    ziegler_nichols_step_settings,
)

PAIR = [("level", "pump")]


def lags(*times, gain=1.0, leads=(), integrators=0, dead_time=0.0):
    return TransferElement(
        gain, tuple(-1.0 / t for t in times), tuple(-1.0 / t for t in leads), integrators, dead_time
    )


# Ultimate points in closed form.


@pytest.mark.parametrize("gain", [1.0, -2.0])
@pytest.mark.parametrize("n", [3, 4, 6])
def test_equal_lags_have_their_closed_form(n, gain):
    # n atan(ω) = π, |g| = cos(π/n)ⁿ
    found = ultimate_point(lags(*[5.0] * n, gain=gain), 0.0)
    assert found.gain == pytest.approx(1.0 / (gain * math.cos(math.pi / n) ** n), rel=1e-12)
    assert found.period == pytest.approx(2 * math.pi * 5.0 / math.tan(math.pi / n), rel=1e-12)


def test_an_integrator_with_delay_has_its_closed_form():
    # Ku = π/(2 k θ), Tu = 4 θ; element and sampling share the delay.
    found = ultimate_point(lags(gain=0.02, integrators=1, dead_time=5.0), 2.0)
    assert found.gain == pytest.approx(math.pi / (2 * 0.02 * 7.0), rel=1e-12)
    assert found.period == pytest.approx(28.0, rel=1e-12)


def test_a_first_order_element_with_delay_solves_its_equation():
    found = ultimate_point(lags(50.0, gain=2.0, dead_time=3.0), 0.0)
    omega = 2 * math.pi / found.period
    assert math.atan(50.0 * omega) + 3.0 * omega == pytest.approx(math.pi, rel=1e-12)
    assert found.gain == pytest.approx(math.hypot(1.0, 50.0 * omega) / 2.0, rel=1e-12)


def test_a_resonance_above_the_first_crossing_limits_the_gain():
    """A second crossing of −540° where |g| is larger is the one that is met first."""
    damped, quick = 0.002, 30.0
    poles = (-1.0, -damped * quick + 1j * quick, -damped * quick - 1j * quick)
    element = TransferElement(1.0, poles, (), 0, 0.25)
    found = ultimate_point(element, 0.0)
    omegas = np.geomspace(0.1, 100.0, 400_001)
    response = np.exp(-0.25j * omegas)
    for pole in poles:
        response = response / (1 - 1j * omegas / pole)
    crossing = np.flatnonzero((np.diff(np.sign(response.imag)) != 0) & (response.real[:-1] < 0))
    largest = np.abs(response[crossing]).max()
    assert 2 * math.pi / found.period > 20.0
    assert found.gain == pytest.approx(1 / largest, rel=1e-3)


@pytest.mark.parametrize(
    ("element", "words"),
    [
        (lags(1.0, 2.0), "never late by half a turn"),
        (TransferElement(1.0, (), (), 1), "never late by half a turn"),
        (TransferElement(1.0, (0.1,), (), 0), "unstable"),
        (TransferElement(1.0, (-1.0, -2.0), (), -1), "static gain is zero"),
        (TransferElement(1.0, (-1.0,), (), 2), "integrates 2 times"),
    ],
)
def test_what_has_no_ultimate_point_is_refused(element, words):
    with pytest.raises(NotApplicable, match=words):
        ultimate_point(element, 0.0)


# Reaction curves.


@pytest.mark.parametrize(
    ("element", "gain", "time_constant", "delay", "figures"),
    [
        # Åström and Hägglund 2006, chapter 7, and 2004, section 6: the three test processes.
        (lags(1.0, 0.1, 0.01, 0.001), 1.0, 1.04, 0.075, (0.005, 0.0005)),
        # Of the four equal lags they print 2.90; e^−t (1 + t + t²/2 + t³/6) = 1/e gives 2.927.
        (lags(1.0, 1.0, 1.0, 1.0), 1.0, 2.927, 1.42, (0.0005, 0.006)),
        (lags(0.05, 0.05, dead_time=1.0), 1.0, 0.0932, 1.01, (0.0005, 0.006)),
    ],
)
def test_reaction_curves_of_the_publication(element, gain, time_constant, delay, figures):
    model = reaction_curve(element, 0.0).model
    assert model.gain == pytest.approx(gain, rel=1e-12)
    assert model.time_constant == pytest.approx(time_constant, abs=figures[0])
    assert model.delay == pytest.approx(delay, abs=figures[1])


def test_a_reaction_curve_in_closed_form():
    # 1/(s + 1)³: y = 1 − e^−t (1 + t + t²/2), steepest at t = 2 with y' = 2 e⁻².
    curve = reaction_curve(lags(1.0, 1.0, 1.0, gain=-3.0), 0.25)
    assert curve.slope == pytest.approx(-6.0 * math.exp(-2.0), rel=1e-12)
    assert curve.delay == pytest.approx(2.25 - (math.exp(2.0) - 5.0) / 2.0, rel=1e-8)
    after = curve.time_constant + curve.delay - 0.25
    assert math.exp(-after) * (1 + after + after**2 / 2) == pytest.approx(math.exp(-1.0), rel=1e-9)


def test_first_order_with_delay_is_its_own_reaction_curve():
    curve = reaction_curve(lags(40.0, gain=2.0, dead_time=3.0), 1.0)
    assert curve.model.slope == pytest.approx(0.05, rel=1e-12)
    assert curve.model.time_constant == pytest.approx(40.0, rel=1e-9)
    assert curve.delay == pytest.approx(4.0, rel=1e-12)
    assert curve.slope == pytest.approx(0.05, rel=1e-12)


def test_the_tangent_of_an_integrating_element_is_its_asymptote():
    # y → k' (t − θ − T1 − T2 + T3)
    element = lags(4.0, 3.0, gain=0.2, leads=[2.0], integrators=1, dead_time=1.5)
    assert reaction_curve(element, 0.5)[:2] == (0.2, pytest.approx(7.0, rel=1e-12))


def test_an_inverse_response_and_a_zero_keep_to_the_exact_step_response():
    from scipy.signal import TransferFunction, impulse, step

    element = TransferElement(2.0, (-1.0, -0.5, -0.1), (0.7, -0.3), 0)
    curve = reaction_curve(element, 0.0)
    numerator = 2.0 * np.polymul([-1 / 0.7, 1.0], [1 / 0.3, 1.0])
    denominator = np.polymul(np.polymul([1.0, 1.0], [2.0, 1.0]), [10.0, 1.0])
    time = np.linspace(0.0, 100.0, 20_001)
    transfer = TransferFunction(numerator, denominator)
    (_, heights), (_, slopes) = (response(transfer, T=time) for response in (step, impulse))
    at = slopes.argmax()
    assert curve.slope == pytest.approx(slopes[at], rel=1e-6)
    assert curve.delay == pytest.approx(time[at] - heights[at] / slopes[at], abs=1e-3)
    to_63 = np.interp(2.0 * (1 - math.exp(-1)), heights[at:], time[at:])
    assert curve.time_constant + curve.delay == pytest.approx(to_63, abs=1e-3)


@pytest.mark.parametrize(
    ("element", "words"),
    [
        (lags(5.0), "no delay"),
        (TransferElement(1.0, (-1.0,), (-2.0,), 0), "answers at once"),
        (TransferElement(1.0, (0.1,), (), 0), "unstable"),
        (TransferElement(1.0, (-1.0,), (), 2), "integrates 2 times"),
        (TransferElement(1.0, (-1.0, -2.0), (), -1), "static gain is zero"),
    ],
)
def test_what_has_no_reaction_curve_is_refused(element, words):
    with pytest.raises(NotApplicable, match=words):
        reaction_curve(element, 0.0)


# The rules.


def test_ziegler_nichols_on_three_equal_lags():
    """Åström and Hägglund, PID Controllers, ISA 1995, examples 4.1 and 4.2: 1/(s + 1)³."""
    element = lags(1.0, 1.0, 1.0)
    curve = reaction_curve(element, 0.0)
    assert curve.slope * curve.delay == pytest.approx(0.218, abs=5e-4)
    assert curve.delay == pytest.approx(0.806, abs=1e-3)
    by_step = ziegler_nichols_step_settings(curve.slope, curve.delay, "PID")
    assert by_step == (
        pytest.approx(5.50, abs=0.006),
        pytest.approx(1.61, abs=0.005),
        pytest.approx(0.403, abs=5e-4),
    )
    by_swing = ziegler_nichols_settings(ultimate_point(element, 0.0), "PID")
    assert by_swing[:2] == (pytest.approx(4.8, rel=1e-9), pytest.approx(1.81, abs=0.005))


def test_ziegler_nichols_table():
    """The table of 1942: 0.45 and 0.6 of Ku, Pu/1.2, Pu/2, Pu/8; 0.9 and 1.2 of 1/(R L)."""
    point = UltimatePoint(-4.0, 12.0)
    assert ziegler_nichols_settings(point) == pytest.approx((-1.8, 10.0, 0.0))
    assert ziegler_nichols_settings(point, "PID") == pytest.approx((-2.4, 6.0, 1.5))
    assert ziegler_nichols_step_settings(0.5, 3.0) == pytest.approx((0.6, 10.0, 0.0))
    assert ziegler_nichols_step_settings(0.5, 3.0, "PID") == pytest.approx((0.8, 6.0, 1.5))


def test_tyreus_luyben_on_an_integrator_with_delay():
    """Tyreus and Luyben 1992: K = 0.487/(k θ) and Ti = 8.75 θ; the rule by Ku, Tu is rounded."""
    k, theta = 0.04, 6.0
    point = ultimate_point(lags(gain=k, integrators=1, dead_time=theta), 0.0)
    setting = tyreus_luyben_settings(point)
    assert setting.gain * k * theta == pytest.approx(0.487, abs=1e-3)
    assert setting.integral_time / theta == pytest.approx(8.75, rel=6e-3)


def test_luyben_pid_is_a_series_form_with_the_reciprocal_ultimate_frequency():
    series = to_series(tyreus_luyben_settings(UltimatePoint(10.0, 2 * math.pi), "PID"))
    assert series == pytest.approx((4.6, 2.2 * 2 * math.pi, 1.0), rel=1e-12)


@pytest.mark.parametrize(
    ("k", "T", "L", "actions", "expected"),
    [
        # Åström and Hägglund 2006, chapter 7: lag-dominated, balanced and delay-dominated.
        (1.0, 1.04, 0.075, "PI", (4.13, 0.539, 0.0)),
        (1.0, 2.90, 1.42, "PI", (0.414, 2.66, 0.0)),
        (1.0, 1.04, 0.075, "PID", (6.44, 0.361, 0.0367)),
        (1.0, 2.90, 1.42, "PID", (1.12, 2.40, 0.619)),
        (1.0, 0.0932, 1.01, "PID", (0.242, 0.474, 0.119)),
    ],
)
def test_amigo_examples(k, T, L, actions, expected):
    found = amigo_settings(DelayedLags(k / T, T, L), actions)
    # The publication prints three figures.
    assert found == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("actions", ["PI", "PID"])
def test_amigo_for_integrating_elements_is_the_limit_of_a_long_lag(actions):
    limit = amigo_settings(DelayedLags(-0.2, math.inf, 3.0), actions)
    long = amigo_settings(DelayedLags(-0.2, 1e9, 3.0), actions)
    # 13.35 L is printed as 13.4 L.
    assert long == pytest.approx(limit, rel=4e-3)


@pytest.mark.parametrize(
    ("element", "first", "second", "delay", "expected"),
    [
        # Skogestad 2003, table 4, PID of cases E2, E4 and E5 for τc = θ, in series form.
        (
            TransferElement(
                1.0,
                tuple(-1 / t for t in (2, 1, 0.4, 0.2, 0.05, 0.05, 0.05)),
                (1 / 0.3, -1 / 0.08),
                0,
            ),
            2.0, 1.2, 0.77, (1.30, 2.0, 1.2),
        ),
        (lags(1, 1, 1, 1), 1.0, 1.5, 1.5, (0.33, 1.0, 1.5)),
        (lags(1, 0.2, 0.04, 0.008), 1.0, 0.22, 0.028, (17.9, 0.224, 0.22)),
    ],
)  # fmt: skip
def test_simc_pid_examples(element, first, second, delay, expected):
    model = half_rule(element, order=2)
    assert model.time_constant == pytest.approx(first, rel=1e-12)
    assert model.second_time_constant == pytest.approx(second, rel=1e-12)
    assert model.delay == pytest.approx(delay, rel=1e-12)
    horizon = 2 * model.delay
    found = simc_settings(model, model.delay)
    K, Ti, Td = 1 / (model.slope * horizon), min(first, 4 * horizon), second
    assert (K, Ti, Td) == pytest.approx(expected, rel=1.1e-2)
    # Both forms are one transfer function.
    for s in (0.1j, 3j):
        isa = found.gain * (1 + 1 / (found.integral_time * s) + found.derivative_time * s)
        assert isa == pytest.approx(K * (1 + 1 / (Ti * s)) * (1 + Td * s), rel=1e-12)


# The designs.


DESIGNS = {
    "ZN": design_ziegler_nichols,
    "ZN step": lambda *a, **o: design_ziegler_nichols(*a, experiment="step_response", **o),
    "TL": design_tyreus_luyben,
    "AMIGO": design_amigo,
}


@pytest.mark.parametrize("actions", ["PI", "PID"])
@pytest.mark.parametrize("name", list(DESIGNS))
def test_designs_keep_the_rule_when_asked_and_a_peak_of_two_else(single_tank, name, actions):
    model = single_tank(
        [[-0.02, 0.0, 0.0], [0.05, -0.05, 0.0], [0.0, 0.04, -0.04]], [0.02, 0, 0], [0, 0, 1.0]
    )
    form = PidForm(actions)
    published = DESIGNS[name](model, PAIR, form=form, as_published=True)
    safe = DESIGNS[name](model, PAIR, form=form)
    peaks = [float(c.design.rpartition("together ")[2][:-1]) for c in (published, safe)]
    ratio = published.values["level.proportional_gain"] / safe.values["level.proportional_gain"]
    if peaks[0] > 2.0:
        assert peaks[1] == 2.0
        assert ratio > 1.0
        assert f"divided by {ratio:.3g}" in safe.notes[1]
        assert "sensitivity peak" in published.notes[1]
    else:
        assert (ratio, peaks[0]) == (1.0, peaks[1])
    if name.startswith("ZN"):
        assert peaks[0] > 2.0
        assert "expect oscillation" in published.notes[-1]


def test_ziegler_nichols_in_the_sampled_loop_is_the_rule(single_tank):
    # Integrator 0.02/s sampled each 4 s: θ = 2 s, Ku = π/(2 · 0.02 · 2), Tu = 8 s.
    model = single_tank([[0.0]], [0.02], [1.0], period=4.0)
    values = design_ziegler_nichols(model, PAIR, as_published=True).values
    assert values["level.proportional_gain"] == pytest.approx(0.45 * math.pi / 0.08, rel=1e-9)
    assert values["level.integral_time"] == pytest.approx(8.0 / 1.2, rel=1e-9)
    found = PidSettings(values["level.proportional_gain"], values["level.integral_time"])
    by_step = design_ziegler_nichols(model, PAIR, experiment="step_response", as_published=True)
    assert by_step.values["level.proportional_gain"] == pytest.approx(0.9 / 0.04, rel=1e-9)
    assert found.gain > 0.0
    # 5 V of room: K = 17.7 uses it up at a step of 0.28 V in 10 V.
    notes = design_ziegler_nichols(model, PAIR, as_published=True).notes
    assert any("setpoint step of 2.8 % of the range saturates" in note for note in notes)


@pytest.mark.parametrize(
    ("design", "pairing", "options", "place", "value"),
    [
        (design_ziegler_nichols, PAIR, {"experiment": "bump"}, "Ziegler-Nichols, experiment",
         "bump"),
        (design_amigo, PAIR, {"form": PidForm("P")}, "AMIGO, form", "P"),
        (design_tyreus_luyben, PAIR, {"form": "PI"}, "Tyreus-Luyben, form", "PI"),
        (design_amigo, [("level", "valve")], {}, "AMIGO, linear model, inputs", "valve"),
    ],
)  # fmt: skip
def test_wrong_requests_are_refused(single_tank, design, pairing, options, place, value):
    with pytest.raises(InputError) as caught:
        design(single_tank([[-0.1]], [0.1], [1.0]), pairing, **options)
    assert (caught.value.place, str(caught.value.value)) == (place, value)


@pytest.mark.parametrize("name", DESIGNS)
def test_reasons_name_the_pair(single_tank, name):
    with pytest.raises(NotApplicable, match="level by pump: the element is unstable"):
        DESIGNS[name](single_tank([[0.1]], [0.1], [1.0]), PAIR)
