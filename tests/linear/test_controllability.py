"""Controllability, observability, Gramians and Hankel singular values."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from models_by_hand import late_feedback, rational
from refusals import refused
from scipy.integrate import quad_vec
from scipy.linalg import eig, expm, svdvals
from scipy.optimize import minimize

from clepsydra.linear.controllability import (
    controllability_margins,
    observability_margins,
    reach_of,
    words_about_reach,
    words_on_reach,
)
from clepsydra.linear.distance_to_uncontrollability import distance_to_uncontrollability
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.frequency_peak import largest_gain
from clepsydra.linear.hankel_singular_values import (
    controllability_gramian,
    hankel_singular_values,
    observability_gramian,
    stable_part,
)
from clepsydra.linear.linearise import linearise
from clepsydra.linear.response import evaluate_transfer


def test_gramian_is_the_integral(random_system):
    system = random_system(4, 3, 2, 2)

    def moving(t):
        reached = expm(system.A * t) @ system.B
        return reached @ reached.T

    def showing(t):
        shown = system.C @ expm(system.A * t)
        return shown.T @ shown

    for gramian, integrand in (
        (controllability_gramian(system.A, system.B), moving),
        (observability_gramian(system.A, system.C), showing),
    ):
        integral, _ = quad_vec(integrand, 0.0, 60.0, epsrel=1e-11)
        np.testing.assert_allclose(gramian, integral, rtol=1e-8, atol=1e-9)


def test_hankel_singular_value_of_one_tank_and_of_two():
    """1/((s + 1)(s + 2)): σ from P Q by hand, σ1 - σ2 = the cross Gramian's trace 1/4."""
    found = hankel_singular_values(rational([[-1.0, 0.0], [1.0, -2.0]], [[1.0], [0.0]],
                                            [[0.0, 1.0]], 0.0))  # fmt: skip
    # For one input and output ±σ are the eigenvalues of the cross Gramian; G(0) = 2 Σ ±σ.
    assert 2 * (found.values[0] - found.values[1]) == pytest.approx(0.5, rel=1e-12)
    # det P Q: P = [[1/2, 1/6], [1/6, 1/12]], Q = [[1/12, 1/12], [1/12, 1/4]].
    assert np.prod(found.values) == pytest.approx(np.sqrt((1 / 24 - 1 / 36) * (1 / 72)), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_hankel_singular_values_by_the_eigenvalues(seed, random_system):
    system = random_system(seed, 5, 2, 3)
    model = rational(system.A, system.B, system.C, system.D)
    P = controllability_gramian(system.A, system.B)
    Q = observability_gramian(system.A, system.C)
    expected = np.sqrt(np.sort(np.linalg.eigvals(P @ Q).real)[::-1])
    np.testing.assert_allclose(hankel_singular_values(model).values, expected, rtol=1e-6)
    # The largest gain over frequency lies between the largest value and twice their sum.
    values = hankel_singular_values(model).values
    peak = largest_gain(model.A, model.B, model.C, model.D).peak
    assert values[0] <= peak <= 2 * values.sum()


def test_integrators_and_unstable_modes_are_split_off(random_system):
    system = random_system(7, 3, 1, 1)
    stable = rational(system.A, system.B, system.C, system.D)
    rest = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.4]])
    mixing = np.random.default_rng(3).standard_normal((6, 6))
    A = np.block([[system.A, np.zeros((3, 3))], [np.zeros((3, 3)), rest]])
    B, C = np.vstack([system.B, np.ones((3, 1))]), np.hstack([system.C, np.ones((1, 3))])
    inverse = np.linalg.inv(mixing)
    found = hankel_singular_values(rational(mixing @ A @ inverse, mixing @ B, C @ inverse, 0.0))
    np.testing.assert_allclose(found.values, hankel_singular_values(stable).values, rtol=1e-7)
    np.testing.assert_allclose(found.split_off, [0.4, 0.0, 0.0], atol=1e-9)


def test_stable_part_and_the_rest_make_the_whole():
    A = np.array([[-1.0, 2.0], [0.0, 0.5]])
    model = rational(A, [[1.0], [3.0]], [[1.0, 1.0]], 0.0)
    part = stable_part(model)
    s = np.array([1.0 + 1j, 3j])
    whole = evaluate_transfer(model.A, model.B, model.C, model.D, s)
    mine = evaluate_transfer(part.A, part.B, part.C, model.D, s)
    # What is left has its pole at 0.5 alone: (s - 0.5) times it is one number.
    left = (whole - mine)[:, 0, 0] * (s - 0.5)
    assert left[0] == pytest.approx(left[1], rel=1e-12)


def test_margin_of_a_mode_is_zero_where_it_is_cut_off(random_system):
    system = random_system(3, 4, 1, 1)
    rates, left = np.linalg.eig(system.A.T)
    real = int(np.argmin(np.abs(rates.imag)))
    assert rates[real].imag == 0.0  # the seed has a real pole
    q = left[:, real].real
    B = system.B - np.outer(q, q @ system.B) / (q @ q)  # out of reach of the mode q
    found = controllability_margins(rational(system.A, B, system.C, 0.0))
    for mode in found:
        cut = bool(abs(mode.pole - rates[real]) < 1e-9)
        assert (mode.margin < 1e-12) is cut
        assert (mode.share < 1e-12) is cut
        test = np.hstack([system.A - mode.pole * np.eye(4), B])
        assert mode.margin == pytest.approx(np.linalg.svd(test)[1][-1], abs=1e-14)


@pytest.mark.parametrize("seed", range(4))
def test_margins_shares_and_states_by_their_definitions(seed, random_system):
    """PBH: [A - pI, B] row by row, [A - pI; C] column by column; parts by left × right."""
    system = random_system(seed, 4, 1, 1)
    scales = np.diag([1.0, 30.0, 0.1, 3.0])  # states in other units
    A = scales @ system.A @ np.linalg.inv(scales)
    B, C = scales @ system.B, system.C @ np.linalg.inv(scales)
    model = rational(A, B, C, system.D)
    rates, left, right = eig(A, left=True, right=True)
    for margins, under in ((controllability_margins(model), False),
                           (observability_margins(model), True)):  # fmt: skip
        assert len(margins) == 4
        for mode in margins:
            place = int(np.argmin(np.abs(rates - mode.pole)))
            assert mode.pole == pytest.approx(rates[place], rel=1e-9)
            shifted = A - rates[place] * np.eye(4)
            test = np.vstack([shifted, C]).T if under else np.hstack([shifted, B])
            assert mode.margin == pytest.approx(svdvals(test)[-1], rel=1e-7)
            shares = test / np.sqrt(np.sum(np.abs(test) ** 2, axis=1))[:, None]
            assert mode.share == pytest.approx(svdvals(shares)[-1], rel=1e-7)
            parts = np.abs(left[:, place] * right[:, place])
            assert mode.state == f"x{int(np.argmax(parts))}"


def test_a_slow_tank_behind_a_fast_valve_is_well_reached():
    model = rational([[-10.0, 0.0], [0.02, -0.01]], [[10.0], [0.0]], np.eye(2), np.zeros((2, 1)))
    assert min(mode.share for mode in controllability_margins(model)) > 0.3
    assert words_on_reach(model) == []


def test_a_row_of_rounding_is_not_reached():
    """A level whose inflow and outflow cancel but for rounding, moved and shown by nothing."""
    model = rational(np.diag([-0.02, 1e-19]), [[1.0], [0.0]], [[1.0, 0.0]], 0.0)
    for margins in (controllability_margins(model), observability_margins(model)):
        assert [mode.state for mode in margins] == ["x1", "x0"]
        assert margins[0].share < 1e-12
        assert margins[1].share > 0.1
    assert words_on_reach(model) == [
        "No input moves the mode at 0 rad/s (mainly x1).",
        "No output shows the mode at 0 rad/s (mainly x1).",
    ]


def test_main_state_has_the_mode_whatever_the_units():
    """x0 drains into x1 alone, so the pole of each tank is that of its own outflow."""
    for unit in (0.01, 1.0, 100.0):  # of x0 beside that of x1
        # A pump from the lower tank to the upper one: the volume in both stays, x1's to drift.
        circulating = rational(
            [[-1.0, 0.0], [unit, 0.0]], [[1.0], [-unit]], np.eye(2), np.zeros((2, 1))
        )
        assert words_on_reach(circulating) == ["No input moves the mode at 0 rad/s (mainly x1)."]
        # The upper tank has no pump, but moves the lower one.
        model = rational([[-1.0, 0.0], [unit, -0.5]], [[0.0], [1.0]], np.eye(2), np.zeros((2, 1)))
        assert "No input moves the mode at -1 rad/s (mainly x0)." in words_on_reach(model)
        assert [mode.state for mode in observability_margins(model)] == ["x1", "x0"]
    # Equal tanks in series, of which the upper has no pump.
    equal = rational([[-1.0, 0.0], [1.0, -1.0]], [[0.0], [1.0]], np.eye(2), np.zeros((2, 1)))
    assert {mode.state for mode in controllability_margins(equal)} == {"x0"}


def test_words():
    model = rational(np.diag([-0.02, -0.01]), [[1e-3], [0.0]], [[1.0, 1.0]], 0.0)
    words = words_on_reach(model)
    assert words[0] == "No input moves the mode at -0.01 rad/s (mainly x1)."
    twins = rational(np.diag([-1.0, -1.0001]), [[1.0], [1.0]], np.eye(2), np.zeros((2, 1)))
    assert any(word.startswith("The inputs hardly reach") for word in words_on_reach(twins))
    swing = rational([[0.0, 2.0], [-0.5, -0.1]], [[0.0], [1.0]], [[0.0, 0.0]], 0.0)
    assert words_on_reach(swing) == [
        "No output shows the mode at -0.05 ± 0.999j rad/s (mainly x0)."
    ]


def test_distance_of_a_pair_with_a_known_one():
    """A = 0: σ_min([-sI, B]) is smallest at s = 0, where it is σ_n(B) for as many inputs."""
    B = np.diag([3.0, 0.2])
    found = distance_to_uncontrollability(np.zeros((2, 2)), B)
    assert found.value == pytest.approx(0.2, rel=1e-9)
    assert found.at_least <= found.value


@pytest.mark.thorough
@pytest.mark.parametrize("seed", range(3))
def test_distance_by_brute_force(seed, random_system):
    system = random_system(seed, 4, 1, 1)
    found = distance_to_uncontrollability(system.A, system.B)
    real, imaginary = np.meshgrid(np.linspace(-6, 3, 361), np.linspace(0, 4, 161))
    points = (real + 1j * imaginary).ravel()
    tests = np.concatenate(
        [system.A - points[:, None, None] * np.eye(4), np.tile(system.B, (len(points), 1, 1))],
        axis=2,
    )
    lowest = np.linalg.svd(tests, compute_uv=False)[:, -1].min()
    assert found.value <= lowest
    assert lowest - found.value < 0.025 * np.sqrt(0.5) + 1e-9  # half a cell's diagonal
    assert 0.98 * found.value <= found.at_least <= found.value
    at_root = np.hstack([system.A - found.root * np.eye(4), system.B])
    assert np.linalg.svd(at_root)[1][-1] == pytest.approx(found.value, rel=1e-12)
    margins = controllability_margins(rational(system.A, system.B, system.C, 0.0))
    assert found.value <= min(mode.margin for mode in margins) * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_no_descent_of_scipy_ends_lower(seed, random_system):
    system = random_system(seed, 5, 2, 1)
    A, B = system.A, system.B
    found = distance_to_uncontrollability(A, B)

    def squared(place):
        return svdvals(np.hstack([A - complex(*place) * np.eye(5), B]))[-1] ** 2

    starts = np.random.default_rng(seed).normal(0.0, np.abs(A).max(), (20, 2))
    lowest = min(minimize(squared, start, options={"gtol": 1e-12}).fun for start in starts)
    assert found.value <= np.sqrt(lowest) * (1.0 + 1e-12)
    assert squared([found.root.real, found.root.imag]) == pytest.approx(found.value**2, rel=1e-12)


def test_distance_where_all_singular_values_are_one():
    assert distance_to_uncontrollability(np.zeros((3, 3)), np.eye(3)).value == 1.0


def test_blocks_of_matrices_find_what_all_at_once_find(random_system, monkeypatch):
    system = random_system(1, 5, 2, 1)
    found = []
    for entries in (1, 100, 10**9):  # one matrix each, two, and all
        monkeypatch.setattr("clepsydra.linear.distance_to_uncontrollability._BLOCK", entries)
        found.append(distance_to_uncontrollability(system.A, system.B))
    assert found[0] == found[1] == found[2]
    assert 0.0 < found[0].at_least <= found[0].value


def test_the_matrices_of_a_search_are_never_all_in_memory(random_system):
    """Thousands of 20 × 21 complex numbers, 7 kB each."""
    system = random_system(2, 20, 1, 1)
    tracemalloc.start()
    try:
        distance_to_uncontrollability(system.A, system.B)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 10e6


def test_distances_of_many_states_are_left_out_and_said(minimum, monkeypatch):
    model = linearise(find_equilibrium(minimum.process))
    whole = reach_of(model)
    assert whole.distance_to_uncontrollability > 0.0 and not whole.note
    monkeypatch.setattr("clepsydra.linear.controllability.MOST_STATES", 3)
    found = reach_of(model).as_dict()
    assert found["distance_to_uncontrollability"] is found["distance_to_unobservability"] is None
    assert "4 states, more than 3" in found["note"]
    assert [mode["margin"] for mode in found["controllability"]] == [
        mode.margin for mode in whole.controllability
    ]


def test_margins_of_very_many_states_are_left_out_and_said(minimum, monkeypatch):
    model = linearise(find_equilibrium(minimum.process))
    for name in ("MOST_STATES", "MOST_MODES"):
        monkeypatch.setattr(f"clepsydra.linear.controllability.{name}", 3)
    found = reach_of(model)
    assert found.controllability == found.observability == []
    assert "each mode" in found.note and "4 states, more than 3" in found.note
    assert words_about_reach(model) == [found.note]
    assert len(found.hankel.values) == 4


def test_distance_of_an_uncontrollable_pair():
    found = distance_to_uncontrollability(np.diag([-1.0, -2.0]), np.array([[1.0], [0.0]]))
    assert found.value == 0.0
    assert found.root == pytest.approx(-2.0)


@pytest.mark.parametrize(
    "function", [controllability_margins, observability_margins, hankel_singular_values]
)
def test_dead_time_is_refused(function):
    with refused(remedy="without_dead_time"):
        function(late_feedback(1.0, 0.5))
