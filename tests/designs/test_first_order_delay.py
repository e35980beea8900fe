"""The half rule against the examples of Skogestad's paper."""

import math

import pytest

from clepsydra import NotApplicable
from clepsydra.designs.models.delayed_lags import DelayedLags, half_rule
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.simc import simc_settings


def made_of(gain, lags, leads=(), integrators=0):
    """Return gain Π(T0 s + 1)/Π(τ s + 1); a negative lead is a zero in the right half-plane."""
    return TransferElement(
        gain, tuple(-1.0 / lag for lag in lags), tuple(-1.0 / lead for lead in leads), integrators
    )


@pytest.mark.parametrize(
    ("element", "delay", "gain", "time_constant", "effective", "controller"),
    [
        # Table 4 there, cases E1 to E5, E7 and E12: k, τ1, θ, then Kc and τI for τc = θ.
        (made_of(1, [1, 0.2]), 0.0, 1.0, 1.1, 0.1, (5.5, 0.8)),
        (
            made_of(1, [2, 1, 0.4, 0.2, 0.05, 0.05, 0.05], [-0.3, 0.08]),
            0.0, 1.0, 2.5, 1.47, (0.85, 2.5),
        ),
        (made_of(2, [20, 1, 0.1, 0.1], [15]), 0.0, 1.5, 1.05, 0.15, (2.33, 1.05)),
        (made_of(1, [1, 1, 1, 1]), 0.0, 1.0, 1.5, 2.5, (0.3, 1.5)),
        (made_of(1, [1, 0.2, 0.04, 0.008]), 0.0, 1.0, 1.1, 0.148, (3.72, 1.1)),
        (made_of(1, [1, 1, 1], [-2]), 0.0, 1.0, 1.5, 3.5, (0.214, 1.5)),
        (made_of(1, [10, 8, 1], [6, 3]), 0.3, 0.225, 1.0, 0.3, (7.41, 1.0)),
    ],
)  # fmt: skip
def test_examples_of_the_paper(element, delay, gain, time_constant, effective, controller):
    model = half_rule(element, delay)
    assert model.gain == pytest.approx(gain, rel=1e-12)
    assert model.time_constant == pytest.approx(time_constant, rel=1e-12)
    assert model.delay == pytest.approx(effective, rel=1e-12)
    settings = simc_settings(model, model.delay)
    # The paper prints three figures.
    assert settings.gain == pytest.approx(controller[0], rel=3e-3)
    assert settings.integral_time == pytest.approx(controller[1], rel=1e-12)


def test_inverse_response_example_of_the_introduction():
    # (−0.1 s + 1)/((5 s + 1)(3 s + 1)(0.5 s + 1)): τ1 = 5 + 3/2, θ = 0.1 + 3/2 + 0.5.
    model = half_rule(made_of(1, [5, 3, 0.5], [-0.1]))
    assert (model.time_constant, model.delay) == (6.5, pytest.approx(2.1, rel=1e-12))


@pytest.mark.parametrize(
    ("lags", "lead", "delay", "gain", "time_constant"),
    [
        ([4.0, 3.0], 5.0, 1.0, 5.0 / 4.0, 3.0),  # T1: no larger lag; T0 ≥ τ0 ≥ θ
        ([10.0, 0.5], 0.7, 0.6, 0.7 / 0.6, 10.0),  # T1a: τ0 = 0.5 is close; T0 ≥ θ ≥ τ0
        ([10.0, 0.5], 0.7, 2.0, 1.0, 10.0),  # T1b: θ ≥ T0 ≥ τ0
        ([10.0, 8.0], 6.0, 0.3, 6.0 / 8.0, 10.0),  # T2: T0 ≥ 5 θ
        ([20.0], 2.0, 1.0, 5.0 / 20.0, 3.0),  # T3 with τ̃0 = 5 θ
        ([4.0], 1.0, 1.0, 1.0, 3.0),  # T3 with τ̃0 = τ0
    ],
)
def test_each_rule_for_a_numerator_time_constant(lags, lead, delay, gain, time_constant):
    model = half_rule(made_of(1.0, lags, [lead]), delay)
    assert model.gain == pytest.approx(gain, rel=1e-12)
    assert model.time_constant == pytest.approx(time_constant, rel=1e-12)
    assert model.delay == delay


def test_an_integrating_element_keeps_its_slope():
    # k'/(s (τ2 s + 1)): half of τ2 is delay; K = 1/(k' 2θ), Ti = 8 θ at τc = θ.
    model = half_rule(made_of(0.2, [4.0], integrators=1), 1.0)
    assert model == DelayedLags(0.2, math.inf, 3.0)
    assert simc_settings(model, 3.0) == (pytest.approx(1 / 1.2), 24.0, 0.0)


def test_a_lead_beside_an_integrator_is_the_limit_of_a_long_lag():
    for lead, delay in ((8.0, 1.0), (2.0, 1.0)):
        limit = half_rule(made_of(0.2, [3.0], [lead], integrators=1), delay)
        long = half_rule(made_of(0.2 * 1e12, [1e12, 3.0], [lead]), delay)
        assert limit.slope == pytest.approx(long.slope, rel=1e-9)
        assert limit.delay == pytest.approx(long.delay, rel=1e-9)


def test_a_negative_gain_gives_a_negative_controller():
    settings = simc_settings(half_rule(made_of(-2.0, [10.0]), 1.0), 1.0)
    assert settings == (-2.5, 8.0, 0.0)


@pytest.mark.parametrize(
    ("element", "reason"),
    [
        (TransferElement(1.0, (0.1,), (), 0), "unstable"),
        (TransferElement(1.0, (-0.1 + 0.3j, -0.1 - 0.3j), (), 0), "oscillates"),
        (TransferElement(1.0, (-1.0,), (), 2), "integrates 2 times"),
        (TransferElement(1.0, (-1.0, -2.0), (), -1), "static gain is zero"),
        (TransferElement(1.0, (), (), 0), "no lag"),
        (TransferElement(1.0, (-1.0,), (-2.0,), 0), "no lag is left"),
    ],
)
def test_what_the_half_rule_cannot_reduce_is_refused(element, reason):
    with pytest.raises(NotApplicable, match=reason):
        half_rule(element)
