"""Placement of poles by second routes, and what is left alone."""

import math

import numpy as np
import pytest
from scipy.linalg import solve_sylvester
from scipy.optimize import linear_sum_assignment
from scipy.signal import besselap, place_poles

from clepsydra import InputError, NotApplicable
from clepsydra.designs.states.bessel_filter import bessel_poles, bessel_radius
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.placement import (
    correction,
    placed_gain,
    slow_modes_gain,
)
from clepsydra.designs.states.robust_assignment import assigned_gain
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process

POLES = [0.9, 0.85 + 0.05j, 0.85 - 0.05j]


def distance(found, wanted):
    distances = np.abs(np.asarray(found)[:, None] - np.asarray(wanted))
    rows, columns = linear_sum_assignment(distances)
    return distances[rows, columns].max()


@pytest.fixture(scope="module")
def three_tanks():
    return observed_process(analyse(load_process("three-tanks")).model, None)


def ackermann(held, moved, poles):
    """Return [0 … 0 1] (Γ, Φ Γ, …)⁻¹ p(Φ)."""
    n = len(held)
    columns = [moved[:, 0]]
    for _ in range(n - 1):
        columns.append(held @ columns[-1])
    polynomial = np.zeros((n, n))
    for coefficient in np.poly(poles).real:
        polynomial = polynomial @ held + coefficient * np.eye(n)
    return np.linalg.solve(np.column_stack(columns).T, np.eye(n)[-1]) @ polynomial


def by_sylvester(held, moved, poles):
    """Return F = G X⁻¹ with Φ X − X Λ = Γ G (Bhattacharyya and de Souza)."""
    real, pair = poles[0], poles[1]
    form = np.zeros((3, 3))
    form[0, 0] = real
    form[1:, 1:] = [[pair.real, pair.imag], [-pair.imag, pair.real]]
    G = np.array([[1.0, 1.0, 0.5]])
    X = solve_sylvester(held, -form, moved @ G)
    return (G @ np.linalg.inv(X))[0]


def test_three_methods_give_one_gain(three_tanks):
    held, moved = three_tanks.held, three_tanks.moved
    found = placed_gain(held, moved, POLES, three_tanks.sizes, np.ones(1), 1.0)[0]
    assert found == pytest.approx(ackermann(held, moved, POLES), rel=1e-7)
    assert found == pytest.approx(by_sylvester(held, moved, POLES), rel=1e-7)
    assert distance(np.linalg.eigvals(held - moved @ found[None]), POLES) < 1e-9


def test_with_two_inputs_the_eigenvalues_are_those_asked_for(minimum_phase):
    seen = observed_process(minimum_phase.model, None)
    poles = [0.9, 0.92, 0.95 + 0.02j, 0.95 - 0.02j]
    moves = np.array([3.0, 7.0])
    gain = placed_gain(seen.held, seen.moved, poles, seen.sizes, moves, 1.0)
    assert distance(np.linalg.eigvals(seen.held - seen.moved @ gain), poles) < 1e-10


@pytest.mark.parametrize("period", [0.01, 1.0, 30.0])
def test_however_fast_the_sampling_is(minimum_phase, sampled_at, period):
    seen = observed_process(sampled_at(minimum_phase.model, period), None)
    rates = np.array([-0.05, -0.06, -0.08 + 0.03j, -0.08 - 0.03j])
    gain = placed_gain(
        seen.held, seen.moved, np.exp(rates * period), seen.sizes, np.full(2, 3.0), period
    )
    found = np.log(np.linalg.eigvals(seen.held - seen.moved @ gain)) / period
    assert distance(found, rates) < 1e-8


@pytest.mark.parametrize("order", range(1, 9))
def test_bessel_pattern_overshoots_by_less_than_one_percent(order):
    period = 0.01
    poles = bessel_poles(order, 1.0, period)
    rates = np.log(poles) / period
    time = np.linspace(0.0, 15.0, 3000)
    # Step response of Π(−p)/Π(s − p) by partial fractions.
    response = np.ones_like(time, dtype=complex)
    for pole in rates:
        others = rates[rates != pole]
        residue = np.prod(-rates) / (pole * np.prod(pole - others))
        response += residue * np.exp(pole * time)
    assert response.real.max() < 1.01
    # The bandwidth is where the gain is 1/√2.
    assert abs(np.prod(-rates) / np.prod(1j - rates)) == pytest.approx(math.sqrt(0.5), rel=1e-9)
    assert bessel_radius(order) == pytest.approx(np.abs(rates).min(), rel=1e-9)


@pytest.mark.parametrize("order", [1, 2, 9, 24, 41])
def test_bessel_pattern_by_scipy(order):
    found = np.log(bessel_poles(order, 1.0, 0.01)) / 0.01
    wanted = besselap(order, norm="mag")[1]
    assert distance(found, wanted) < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize("real", range(6))
def test_eigenvectors_are_as_orthogonal_as_those_of_scipy(real):
    random = np.random.default_rng(real)
    A, B = random.normal(size=(real + 4, real + 4)), random.normal(size=(real + 4, 3))
    pairs = np.array([-1.0 + 1.0j, -2.0 + 0.5j])
    wanted = np.concatenate([pairs, pairs.conj(), -1.0 - np.arange(real)])
    found, reference = assigned_gain(A, B, wanted), place_poles(A, B, wanted).gain_matrix
    assert found == pytest.approx(reference, rel=1e-6)
    assert distance(np.linalg.eigvals(A - B @ found), wanted) < 1e-9


def test_a_complex_pole_without_its_conjugate_and_inputs_that_act_alike_are_refused():
    A, alike = np.diag([1.0, 2.0, 3.0]), np.ones((3, 2))
    with pytest.raises(np.linalg.LinAlgError):
        assigned_gain(A, alike[:, :1], np.array([-1.0, -2.0, -3.0 + 1.0j]))
    with pytest.raises(NotApplicable, match="too much alike"):
        placed_gain(A, alike, [0.5, 0.4, 0.3], np.ones(3), np.ones(2), 1.0)


def test_fast_modes_stay_and_slow_ones_have_the_pattern(three_tanks):
    held, moved, period = three_tanks.held, three_tanks.moved, three_tanks.period
    rates = np.sort(-np.log(np.linalg.eigvals(held).real) / period)
    # Between the first and the second mode: one is moved.
    bandwidth = math.sqrt(rates[0] * rates[1])
    gain = slow_modes_gain(held, moved, bandwidth, three_tanks.sizes, np.ones(1), period)
    found = np.sort(-np.log(np.linalg.eigvals(held - moved @ gain).real) / period)
    assert found == pytest.approx(np.sort([bandwidth, *rates[1:]]), rel=1e-9)
    # Above all of them: three.
    gain = slow_modes_gain(held, moved, 0.2, three_tanks.sizes, np.ones(1), period)
    poles = np.linalg.eigvals(held - moved @ gain)
    assert distance(poles, bessel_poles(3, 0.2, period)) < 1e-9
    # Below all of them: none.
    gain = slow_modes_gain(held, moved, 1e-4, three_tanks.sizes, np.ones(1), period)
    assert not gain.any()


def test_a_luenberger_observer_is_the_dual_placement(three_tanks):
    held, shown = three_tanks.held, np.array([[0.0, 0.0, 1.0]])
    scales = three_tanks.sizes, np.array([0.7]), 1.0
    found = correction(placed_gain, held, shown, POLES, *scales)
    assert found[:, 0] == pytest.approx(ackermann(held.T, (shown @ held).T, POLES), rel=1e-7)
    assert distance(np.linalg.eigvals(held - found @ shown @ held), POLES) < 1e-9
    found = correction(slow_modes_gain, held, shown, 0.2, *scales)
    assert (
        distance(np.linalg.eigvals(held - found @ shown @ held), bessel_poles(3, 0.2, 1.0)) < 1e-9
    )


def test_what_is_out_of_reach_is_named():
    held, moved = np.diag(np.exp([-0.01, -0.02])), np.array([[0.0], [1.0]])
    ones = np.ones(2), np.ones(1)
    with pytest.raises(NotApplicable, match="a mode of 100 s is out of reach"):
        placed_gain(held, moved, [0.5, 0.4], *ones, 1.0, "pole placement")
    with pytest.raises(NotApplicable, match="that integrates is not shown by the measurements"):
        correction(placed_gain, np.diag([1.0, 0.9]), moved.T, [0.5, 0.4], *ones, 1.0)


@pytest.mark.parametrize(
    ("poles", "words"),
    [
        ([0.9, 0.8], "3 numbers"),
        (0.9, "3 numbers"),
        ([0.9, "0.8", 0.7], "3 numbers"),
        ([0.9, 0.8, 1.0], "inside the unit circle"),
        ([0.9, 0.8, -1.2], "inside the unit circle"),
        ([0.9, 0.8, math.nan], "inside the unit circle"),
        ([0.9, 0.8 + 0.1j, 0.8 + 0.1j], "with its conjugate"),
        ([0.9, 0.8, 0.8], "at most 1 times"),
    ],
)
def test_wrong_poles_are_refused(three_tanks, poles, words):
    with pytest.raises(InputError, match=words):
        placed_gain(three_tanks.held, three_tanks.moved, poles, np.ones(3), np.ones(1), 1.0)
