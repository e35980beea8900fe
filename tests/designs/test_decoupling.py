"""Inverted decouplers: exact ones by matrix algebra, others by their derivatives at zero."""

import math

import numpy as np
import pytest
from refusals import refused

from clepsydra import NotApplicable
from clepsydra.designs.decoupling import LeadLag, decoupling_element, inverted_decoupler
from clepsydra.designs.loops.pairing import paired_loops
from clepsydra.designs.models.transfer_element import TransferElement
from clepsydra.designs.simc import design_simc
from clepsydra.linear.response import frequency_response

DIRECT = [("level_1", "pump_1"), ("level_2", "pump_2")]
CROSS = [("level_1", "pump_2"), ("level_2", "pump_1")]


def decoupled(model, pairing, kind="dynamic"):
    """Return the elements of a decoupler, as arrays for each of their numbers."""
    return LeadLag(*np.moveaxis(inverted_decoupler(paired_loops(model, pairing), kind), 2, 0))


def values_at(decoupler, s):
    return decoupler.gain * (decoupler.lead * s + 1) / (decoupler.lag * s + 1)


def seen(model, pairing, decoupler, omega):
    """Return the process that the controllers see: G (I − D)⁻¹ at jω."""
    G = frequency_response(model.select(*zip(*pairing, strict=True)), omega)[0]
    D = values_at(decoupler, 1j * omega)
    return G, G @ np.linalg.inv(np.eye(len(D)) - D)


@pytest.mark.parametrize("omega", [1e-4, 0.01, 0.3])
def test_the_controllers_of_the_quadruple_tank_see_their_own_element_only(minimum_phase, omega):
    found = decoupled(minimum_phase.model, DIRECT)
    assert found.exact.all()
    G, apparent = seen(minimum_phase.model, DIRECT, found, omega)
    assert np.diag(apparent) == pytest.approx(np.diag(G), rel=1e-9)
    assert abs(apparent[0, 1]) + abs(apparent[1, 0]) < 1e-9 * abs(np.diag(G)).min()


def test_its_elements_have_the_lag_of_the_upper_tanks(minimum_phase):
    found = decoupled(minimum_phase.model, DIRECT)
    assert [found.lag[0, 1], found.lag[1, 0]] == pytest.approx(minimum_phase.T[[2, 3]], rel=1e-9)
    ratios = minimum_phase.cross_gains / minimum_phase.direct_gains
    assert [found.gain[0, 1], found.gain[1, 0]] == pytest.approx(-ratios, rel=1e-9)
    assert not found.lead.any()


@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_a_pairing_with_a_negative_relative_gain_would_run_away(nonminimum_phase, kind):
    with pytest.raises(NotApplicable, match=r"feed each other with a gain of 1.* at rest"):
        decoupled(nonminimum_phase.model, DIRECT, kind=kind)


def test_what_acts_later_than_the_other_cannot_be_decoupled_but_at_rest(nonminimum_phase):
    with pytest.raises(NotApplicable, match=r"level_1 by pump_2 and pump_1: .* 2 lags .* 1, so"):
        decoupled(nonminimum_phase.model, CROSS)
    found = decoupled(nonminimum_phase.model, CROSS, kind="static")
    G, apparent = seen(nonminimum_phase.model, CROSS, found, 1e-9)
    assert apparent == pytest.approx(np.diag(np.diag(G)), abs=1e-6)


def lags(gain, *times, leads=(), dead_time=0.0, integrators=0):
    return TransferElement(
        gain, tuple(-1 / t for t in times), tuple(-1 / t for t in leads), integrators, dead_time
    )


@pytest.mark.parametrize(
    ("own", "cross", "expected"),
    [
        (lags(2.0, 10.0), lags(1.0, 4.0), (-0.5, 10.0, 4.0, True)),
        (lags(2.0, 10.0), lags(1.0, 10.0), (-0.5, 0.0, 0.0, True)),
        (lags(2.0, 10.0), lags(1.0, 10.0, 3.0), (-0.5, 0.0, 3.0, True)),
        (lags(2.0, 10.0, leads=[2.0]), lags(1.0, 4.0, 10.0), None),
        (lags(2.0, integrators=1), lags(1.0, 4.0, integrators=1), (-0.5, 0.0, 4.0, True)),
        (lags(2.0, integrators=1), lags(1.0, 4.0), (0.0, 0.0, 0.0, False)),
    ],
)
def test_elements_of_first_order_are_exact(own, cross, expected):
    found = decoupling_element(own, cross, "dynamic")
    if expected is None:
        # −(1/2)(1/((4 s + 1)(2 s + 1))): two lags, one of them from the zero of its own element.
        assert not found.exact
        return
    assert found == (*map(pytest.approx, expected[:3]), expected[3])


@pytest.mark.parametrize(
    ("own", "cross"),
    [
        (lags(2.0, 30.0), lags(1.0, 8.0, 5.0)),
        (lags(2.0, 30.0), lags(1.0, 8.0, 5.0, dead_time=3.0)),
        (lags(1.0, 40.0, 3.0, dead_time=1.0), lags(-2.0, 30.0, 4.0, 2.0, dead_time=1.0)),
    ],
)
def test_others_have_gain_and_two_derivatives_at_zero(own, cross):
    found = decoupling_element(own, cross, "dynamic")
    assert found.lag > 0.0
    assert found.lead >= 0.0
    # Both as power series in s, by contour integrals around zero.
    turns = np.exp(2j * np.pi * np.arange(64) / 64)
    s = 1e-3 * turns

    def g(element):
        value = element.gain * np.exp(-s * element.dead_time)
        for pole in element.poles:
            value = value / (1 - s / pole)
        return value

    exact = np.fft.fft(-g(cross) / g(own))[:3] / 64 / 1e-3 ** np.arange(3)
    near = np.fft.fft(found.gain * (found.lead * s + 1) / (found.lag * s + 1))[:3] / 64
    assert (near / 1e-3 ** np.arange(3)).real == pytest.approx(exact.real, rel=1e-6)


@pytest.mark.parametrize(
    ("own", "cross", "first"),
    [
        (lags(1.0, 10.0, 10.0), lags(1.0, 1.0, 1.0), 18.0),  # needs more lead than can be had
        (lags(1.0, 2.0), lags(1.0, 2.0, dead_time=6.0), -6.0),  # a delay is a lag
    ],
)
def test_where_no_lead_lag_has_both_it_has_the_first_derivative(own, cross, first):
    found = decoupling_element(own, cross, "dynamic")
    assert found.lead - found.lag == pytest.approx(first, rel=1e-12)
    assert 0.0 <= found.lead <= 10.0 * found.lag * (1 + 1e-12)


@pytest.mark.parametrize(
    ("own", "cross", "words"),
    [
        (lags(1.0, 5.0, dead_time=2.0), lags(1.0, 5.0, dead_time=1.0), "1 s later"),
        (lags(1.0, 5.0, 3.0), lags(1.0, 5.0), "2 lags"),
        (lags(1.0, 5.0, 3.0, leads=[-2.0]), lags(1.0, 5.0), "wrong way"),
        (lags(1.0, 5.0), lags(1.0, 5.0, integrators=1), "integrates and its own does not"),
    ],
)
def test_elements_that_cannot_be_realised_are_refused(own, cross, words):
    with pytest.raises(NotApplicable, match=words):
        decoupling_element(own, cross, "dynamic")


@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_a_static_one_is_the_gain_alone(kind):
    found = decoupling_element(lags(-4.0, 7.0), lags(2.0, 7.0), kind)
    assert (found.gain, found.lead, found.lag) == (0.5, 0.0, 0.0)


def test_wrong_requests_are_refused(minimum_phase):
    with pytest.raises(NotApplicable, match="one loop only"):
        decoupled(minimum_phase.model, DIRECT[:1])
    with refused(place="SIMC, decoupling", expected="one of static, dynamic"):
        design_simc(minimum_phase.model, DIRECT, decoupling="perfect")
    with refused(value="level_1", expected="each name once"):
        decoupled(minimum_phase.model, [("level_1", "pump_1")] * 2)
    assert math.isfinite(decoupled(minimum_phase.model, DIRECT).gain.sum())
