"""Relative gains, pairing and the Niederlinski index."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from refusals import refused

from clepsydra import LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.relative_gain_array import (
    niederlinski_index,
    relative_gain_array,
    relative_gains,
    suggest_pairing,
)


def quadruple(plant):
    model = linearise(find_equilibrium(plant.process))
    return model.select(outputs=["level_1", "level_2"])


def test_quadruple_tank_equals_the_closed_form(johansson):
    found, value = relative_gains(quadruple(johansson)), johansson.relative_gain
    np.testing.assert_allclose(found, [[value, 1 - value], [1 - value, value]], rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_open_over_closed_loop_gain(seed):
    # The definition itself: all other outputs held by the other inputs.
    G = np.random.default_rng(seed).standard_normal((4, 4))
    found = relative_gain_array(G)
    for i, j in np.ndindex(4, 4):
        others = np.delete(np.delete(G, i, 0), j, 1)
        held = np.linalg.solve(others, -np.delete(G[:, j], i))
        closed = G[i, j] + np.delete(G[i], j) @ held
        assert found[i, j] == pytest.approx(G[i, j] / closed, rel=1e-10)
    np.testing.assert_allclose(found.sum(axis=0), 1, rtol=1e-12)


def test_units_do_not_matter():
    G = np.random.default_rng(1).standard_normal((3, 3))
    scaled = np.diag([1e9, 1e-3, 1.0]) @ G @ np.diag([1e-8, 1.0, 1e5])
    np.testing.assert_allclose(relative_gain_array(scaled), relative_gain_array(G), rtol=1e-10)


def test_sums_of_an_array_that_is_not_square():
    G = np.random.default_rng(2).standard_normal((2, 3))
    found = relative_gain_array(G)
    np.testing.assert_allclose(found.sum(axis=1), 1, rtol=1e-12)  # G pinv(G) = I
    tall = relative_gain_array(G.T)
    np.testing.assert_allclose(tall.sum(axis=0), 1, rtol=1e-12)


def test_complex_gains():
    G = np.array([[1.0, 1j], [1j, 2.0]])
    np.testing.assert_allclose(relative_gain_array(G), [[2 / 3, 1 / 3], [1 / 3, 2 / 3]])


@pytest.mark.parametrize(
    "gain", [[[1.0, 2.0], [2.0, 4.0]], [[1.0, 0.0], [1.0, 0.0]], [[1e-9, 1.0], [1e-18, 1e-9]]]
)
def test_a_singular_gain_is_refused(gain):
    with refused(remedy="cannot be set independently"):
        relative_gain_array(gain)


def test_an_infinite_gain_is_refused():
    with refused(expected="finite gains"):
        relative_gain_array([[np.inf, 1.0], [0.0, 1.0]])


def test_integrating_rows_have_the_limit():
    # Tank 0 integrates, tank 1 drains: G = [[1/s, 2/s], [3/(s + 1), 1/(s + 1)]], so that
    # Λ = 1/(1 - 6) at every s.
    B = np.array([[1.0, 2.0], [3.0, 1.0]])
    model = LinearModel(
        np.diag([0.0, -1.0]), B, B[:, :0], np.eye(2), np.zeros((2, 2)),
        ("a", "b"), ("u", "v"), (), ("y", "z"),
    )  # fmt: skip
    np.testing.assert_allclose(relative_gains(model), [[-0.2, 1.2], [1.2, -0.2]], rtol=1e-9)


def test_a_limit_that_depends_on_frequency():
    # G = [[1/s, 1/s], [1/(s + 1), 4/(s + 2)]]: λ(s) = 4 (s + 1)/(3 s + 2), which tends to 2.
    A = np.diag([0.0, -1.0, -2.0])
    B = np.array([[1.0, 1.0], [1.0, 0.0], [0.0, 4.0]])
    C = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])
    model = LinearModel(
        A, B, B[:, :0], C, np.zeros((2, 2)), ("a", "b", "c"), ("u", "v"), (), ("y", "z")
    )
    np.testing.assert_allclose(relative_gains(model)[0], [2.0, -1.0], rtol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_two_integrators_in_series_in_a_random_basis(seed):
    # G = [[1/s², 1/s²], [1/(s + 1), 4/(s + 2)]], the λ(s) of above. Rounding splits the double
    # pole into ±√ε, which is no reason to solve with the singular A.
    A = np.diag([0.0, 0.0, -1.0, -2.0])
    A[1, 0] = 1.0
    B = np.array([[1.0, 1.0], [0.0, 0.0], [1.0, 0.0], [0.0, 4.0]])
    C = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
    T = np.linalg.qr(np.random.default_rng(seed).standard_normal((4, 4)))[0]
    T = T @ np.diag([1.0, 3.0, 0.5, 2.0])
    model = LinearModel(
        T @ A @ np.linalg.inv(T), T @ B, B[:, :0], C @ np.linalg.inv(T), np.zeros((2, 2)),
        tuple("abcd"), ("u", "v"), (), ("y", "z"),
    )  # fmt: skip
    # A shift by √ε in frequency moves λ by about as much, times what T amplifies.
    np.testing.assert_allclose(relative_gains(model)[0], [2.0, -1.0], rtol=1e-6)


def test_pairing_of_both_phases(minimum, nonminimum):
    names = ("level_1", "level_2"), ("pump_1", "pump_2")
    straight = suggest_pairing(relative_gains(quadruple(minimum)), *names)
    assert straight == [("level_1", "pump_1"), ("level_2", "pump_2")]
    crossed = suggest_pairing(relative_gains(quadruple(nonminimum)), *names)
    assert crossed == [("level_1", "pump_2"), ("level_2", "pump_1")]


def test_a_negative_relative_gain_is_avoided_at_any_price():
    # The straight pairing is nearer to one in sum, but one of its gains is negative.
    gains = np.array([[1.0, 60.0, -60.0], [0.0, -0.1, 1.1], [0.0, 1.1, -0.1]])
    pairs = suggest_pairing(gains, "abc", "xyz")
    assert pairs == [("a", "x"), ("b", "z"), ("c", "y")]
    gains = np.array([[-0.01, 9.0], [9.0, 0.9]])
    assert suggest_pairing(gains, "ab", "xy") == [("a", "y"), ("b", "x")]


@pytest.mark.parametrize("shape", [(2, 4), (4, 2), (7, 8), (8, 7)])
def test_every_other_pairing_costs_more(shape):
    gains = np.random.default_rng(7).uniform(0.1, 3.0, shape)
    outputs, inputs = [f"y{i}" for i in range(shape[0])], [f"u{i}" for i in range(shape[1])]
    pairs = suggest_pairing(gains, outputs, inputs)
    assert len(pairs) == min(shape)
    assert [output for output, _ in pairs] == sorted(output for output, _ in pairs)
    cost = np.abs(1 - gains) if shape[0] <= shape[1] else np.abs(1 - gains.T)
    found = sum(abs(1 - gains[outputs.index(y), inputs.index(u)]) for y, u in pairs)
    every = np.arange(min(shape))
    best = min(cost[every, list(p)].sum() for p in permutations(range(max(shape)), min(shape)))
    assert found == pytest.approx(best, rel=1e-12)


def test_names_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="1×2 names"):
        suggest_pairing(np.eye(2), ["y"], ["u", "v"])


def test_niederlinski_is_the_inverse_relative_gain_of_two_loops(johansson):
    model = quadruple(johansson)
    gain = model.C @ np.linalg.solve(-model.A, model.B)
    pairs = [("level_1", "pump_1"), ("level_2", "pump_2")]
    found = niederlinski_index(gain, pairs, model.outputs, model.inputs)
    assert found == pytest.approx(1 / johansson.relative_gain, rel=1e-9)
    crossed = [("level_1", "pump_2"), ("level_2", "pump_1")]
    found = niederlinski_index(gain, crossed, model.outputs, model.inputs)
    assert found == pytest.approx(1 / (1 - johansson.relative_gain), rel=1e-9)


def test_niederlinski_of_three_loops_by_hand():
    # det = 1 (1 - 0.25) - 2 (2 - 0) + 0 = -3.25, divided by the diagonal 1 · 1 · 1.
    gain = np.array([[1.0, 2.0, 0.0], [2.0, 1.0, 0.5], [0.0, 0.5, 1.0]])
    pairs = list(zip("abc", "xyz", strict=True))
    assert niederlinski_index(gain, pairs, "abc", "xyz") == pytest.approx(-3.25, rel=1e-14)
    shuffled = [("c", "z"), ("a", "x"), ("b", "y")]
    assert niederlinski_index(gain, shuffled, "abc", "xyz") == pytest.approx(-3.25, rel=1e-14)
    zero = [("a", "z"), ("b", "y"), ("c", "x")]
    assert niederlinski_index(gain, zero, "abc", "xyz") == np.inf
    with refused(remedy="does not integrate"):
        niederlinski_index([[np.inf]], [("a", "x")], "a", "x")
