"""Riccati equations and the gains from them, against closed forms and second routes."""

import functools
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl
from clepsydra import InputError, NotApplicable
from clepsydra.designs.kalman import Noise, kalman_gain, process_noise
from clepsydra.designs.states.bryson_rule import bryson_weights
from clepsydra.designs.states.linear_quadratic import lqr_gains, scaled_cost
from clepsydra.designs.states.observed_process import observed_process
from clepsydra.designs.states.quadratic_weights import (
    QuadraticWeights,
    checked_weights,
    diagonal_weights,
)
from clepsydra.designs.states.riccati import optimal_regulator, riccati_residual

CATALOGUE = ["quadruple-tank", "three-tanks", "eight-tanks", "wet-well", "equalisation-tank"]
BEHIND_A_PIPE = Path(__file__).parents[2] / "docs/examples/three-tanks-behind-a-pipe.toml"


@functools.cache
def analysed(name):
    return cl.load(name).analysis


@pytest.mark.parametrize("name", CATALOGUE)
def test_the_residual_of_the_regulator_is_below_1e_9_of_the_largest_term(name):
    seen = observed_process(analysed(name).model, None)
    # Weights by range: levels to a tenth, inputs to a quarter of their ranges.
    spans = np.array([seen.model.point.process.signal(each).span for each in seen.model.inputs])
    Q, R = np.diag((0.1 * seen.sizes) ** -2), np.diag((0.25 * spans) ** -2)
    N = np.zeros((len(Q), len(R)))
    found = optimal_regulator(seen.held, seen.moved, Q, N, R)
    P, K = found.cost, found.gain
    # The other form: the cost of a sample with this gain and of all that follow is P.
    closed = seen.held - seen.moved @ K
    assert np.abs(Q + K.T @ R @ K + closed.T @ P @ closed - P).max() < 1e-9 * np.abs(P).max()
    assert riccati_residual(seen.held, seen.moved, Q, N, R, P) < 1e-9
    assert np.all(np.abs(found.eigenvalues) < 1.0)


def test_scalar_regulator_has_the_closed_form():
    # x⁺ = a x + b u: b² P² + (R − a² R − b² Q) P − Q R = 0.
    a, b, Q, R = 1.1, 0.4, 2.0, 3.0
    middle = R - a * a * R - b * b * Q
    P = (-middle + math.sqrt(middle**2 + 4 * b * b * Q * R)) / (2 * b * b)
    one = np.eye(1)
    found = optimal_regulator(a * one, b * one, Q * one, 0 * one, R * one)
    assert found.cost[0, 0] == pytest.approx(P, rel=1e-12)
    assert found.gain[0, 0] == pytest.approx(a * b * P / (R + b * b * P), rel=1e-12)


def test_lqr_in_physical_units_is_that_of_value_iteration(minimum_phase):
    model, period = minimum_phase.model, 1.0
    weights = bryson_weights(model, np.array([0.7, 1.1]), np.array([2.0, 3.0]), 25.0)
    found = lqr_gains(model, weights, period, 25.0)
    # The cost of a sample by Simpson's rule over states from SciPy's matrix exponential.
    from scipy.linalg import expm

    block = np.zeros((6, 6))
    block[:4, :4], block[:4, 4:] = model.A, model.B
    cost = np.zeros((6, 6))
    times, rule = np.linspace(0.0, period, 101), np.ones(101)
    rule[1:-1:2], rule[2:-1:2] = 4.0, 2.0
    for time, weight in zip(times, rule * period / 300.0, strict=True):
        state = expm(block * time)[:4]
        cost += weight * state.T @ weights.states @ state
    cost[4:, 4:] += period * weights.inputs
    A, B = expm(block * period)[:4, :4], expm(block * period)[:4, 4:]
    P = cost[:4, :4]
    for _ in range(3000):
        K = np.linalg.solve(cost[4:, 4:] + B.T @ P @ B, B.T @ P @ A + cost[4:, :4])
        P = cost[:4, :4] + A.T @ P @ A - (A.T @ P @ B + cost[:4, 4:]) @ K
    assert found.gain == pytest.approx(K, rel=1e-8, abs=1e-9 * np.abs(K).max())


def test_scalar_kalman_gain_by_hand():
    # x⁺ = 0.9 x + w, y = 2 x + v, W = 0.19, V = 4: P = 0.81 P 4/(4 + 4 P) + 0.19, or
    # P² + (1 − 0.81 − 0.19) P − 0.19 = 0, P = √0.19.
    P = math.sqrt(0.19)
    one = np.eye(1)
    found = kalman_gain(0.9 * one, 2.0 * one, Noise(0.19 * one, 4.0 * one, ""))
    assert found.covariance[0, 0] == pytest.approx(P, rel=1e-12)
    assert found.gain[0, 0] == pytest.approx(2 * P / (4 * P + 4), rel=1e-12)
    assert found.eigenvalues[0] == pytest.approx(0.9 * (1 - 4 * P / (4 * P + 4)), rel=1e-12)


@pytest.mark.parametrize("name", CATALOGUE)
def test_kalman_gain_is_where_the_difference_equation_settles(name):
    seen = observed_process(analysed(name).model, None)
    noise = process_noise(seen, 60.0 * seen.period)
    found = kalman_gain(seen.held, seen.shown, noise)
    # Doubling: each step stands for twice as many samples as the last.
    A, G, H = seen.held.T, seen.shown.T @ np.linalg.inv(noise.measurement) @ seen.shown, None
    H = noise.process
    one = np.eye(len(A))
    for _ in range(40):
        inverse = np.linalg.inv(one + G @ H)
        A, G, H = A @ inverse @ A, G + A @ inverse @ G @ A.T, H + A.T @ H @ inverse @ A
    assert found.covariance == pytest.approx(H, rel=1e-7, abs=1e-9 * np.abs(H).max())
    gain = H @ seen.shown.T @ np.linalg.inv(seen.shown @ H @ seen.shown.T + noise.measurement)
    assert found.gain == pytest.approx(gain, rel=1e-6, abs=1e-9 * np.abs(gain).max())


def test_a_random_walk_of_the_noise_moves_as_the_load_does(single_tank):
    """An integrator ẋ = u: in the horizon noise of the input moves it by 0.1 · 5 V · horizon."""
    model = single_tank([[0.0]], [2e-3], [1.0])
    seen = observed_process(model, ["level"])
    horizon = 40.0
    noise = process_noise(seen, horizon)
    after_the_horizon = noise.process[0, 0] * horizon / seen.period
    assert math.sqrt(after_the_horizon) == pytest.approx(2e-3 * 0.5 * horizon, rel=1e-12)
    assert noise.measurement[0, 0] == pytest.approx((0.005 * 10.0) ** 2, rel=1e-12)


def test_the_noise_that_the_process_gives_is_taken():
    seen = observed_process(analysed("wet-well").model, None)
    assert process_noise(seen, 60.0).measurement[0, 0] == pytest.approx((0.002 * 0.016) ** 2)


def test_load_steps_are_noise_of_their_tank():
    model = analysed("eight-tanks").model
    seen = observed_process(model, None)
    without = SimpleNamespace(load_steps=dict)
    import dataclasses

    process = dataclasses.replace(model.point.process, elements=(without,))
    point = dataclasses.replace(model.point, process=process)
    bare = dataclasses.replace(seen, model=dataclasses.replace(seen.model, point=point))
    horizon = 600.0
    added = process_noise(seen, horizon).process - process_noise(bare, horizon).process
    # Tank 1: A ḣ = d − K h. ∫ e^(−2 t/τ) dt over a sample, times (d̄/A)² T.
    area, tau, load = 0.649351, 120.0, 0.04 / 60.0
    variance = (load / area) ** 2 * horizon * tau / 2 * (1 - math.exp(-2 * 60.0 / tau))
    assert added[0, 0] == pytest.approx(variance, rel=1e-5)


def test_what_cannot_be_regulated_or_estimated_is_refused():
    one, none = np.eye(2), np.zeros((2, 1))
    held, moved = np.diag([1.2, 0.5]), np.array([[0.0], [1.0]])
    with pytest.raises(NotApplicable, match="out of reach"):
        optimal_regulator(held, moved, one, none, np.eye(1))
    with pytest.raises(NotApplicable, match="do not show a state"):
        kalman_gain(np.diag([1.0, 0.5]), moved.T, Noise(one, np.eye(1), ""))


@pytest.mark.parametrize(
    ("states", "inputs", "integrals", "words"),
    [
        ([[1.0, 0.0], [0.0, -1.0]], [[1.0]], None, "not negative"),
        ([[1.0, 2.0], [2.0, 1.0]], [[1.0]], None, "not negative"),
        ([[1.0, 0.5], [0.0, 1.0]], [[1.0]], None, "symmetric"),
        (np.eye(2), [[0.0]], None, "positive definite"),
        (np.eye(2), [[1.0]], [[0.0]], "positive definite"),
        (np.eye(2), [1.0], None, "square"),
        ([[math.nan]], [[1.0]], None, "finite"),
        ("heavy", [[1.0]], None, "square"),
    ],
)
def test_weights_that_are_not_definite_are_refused(states, inputs, integrals, words):
    with pytest.raises(InputError, match=words):
        QuadraticWeights(states, inputs, integrals)


def test_weights_that_do_not_fit_or_name_nothing_are_refused(minimum_phase):
    model = minimum_phase.model
    with refused(place="weights, inputs", expected="for pump_1, pump_2"):
        checked_weights(QuadraticWeights(np.eye(4), np.eye(1)), model)
    with pytest.raises(InputError, match=r"tank_5.*one of tank_1\.level"):
        diagonal_weights(model, {"tank_5.level": 1.0}, {"pump_1": 1.0, "pump_2": 1.0})
    with refused(remedy="add pump_2"):
        diagonal_weights(model, {"tank_1.level": 1.0}, {"pump_1": 1.0})
    with refused(expected="not below zero"):
        diagonal_weights(model, {"tank_1.level": -1.0}, {"pump_1": 1.0, "pump_2": 1.0})


@pytest.fixture
def without_scipy(monkeypatch):
    """What SciPy says of matrices whose eigenvalues it cannot sort."""
    import scipy.linalg

    def refuse(*matrices, **more):
        raise ValueError("Reordering of (A, B) failed")

    return lambda: monkeypatch.setattr(scipy.linalg, "solve_discrete_are", refuse)


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_scipy_cannot_reorder_is_found_by_doubling(name, without_scipy):
    seen = observed_process(analysed(name).model, None)
    Q, R = np.diag((0.1 * seen.sizes) ** -2), np.eye(seen.moved.shape[1])
    N = 0.01 * np.sqrt(np.diag(Q))[:, None] * np.ones((1, len(R)))
    found = optimal_regulator(seen.held, seen.moved, Q, N, R)
    without_scipy()
    again = optimal_regulator(seen.held, seen.moved, Q, N, R)
    # Both are refined alike; what is left is the last digits.
    assert np.abs(again.gain - found.gain).max() < 1e-9 * np.abs(found.gain).max()


def test_what_has_no_solution_is_not_applicable_by_doubling_either(without_scipy):
    without_scipy()
    one = np.eye(1)
    with pytest.raises(NotApplicable, match="too ill-conditioned to be solved"):
        optimal_regulator(2.0 * one, 0.0 * one, one, 0.0 * one, one)


def test_a_filter_is_found_however_many_readings_are_on_their_way(tmp_path):
    """SciPy sorts the eigenvalues of some of these numbers of readings, and of some not."""
    text = (BEHIND_A_PIPE.parent / "sample-line.toml").read_text(encoding="utf-8")
    for late in (10, 15, 20, 25, 30, 35):
        path = tmp_path / f"late-{late}.toml"
        assert text.count('component = "acid"') == 1
        path.write_text(
            text.replace('component = "acid"', f'component = "acid"\ndead_time = "{late} s"')
        )
        controller = cl.design.lqi_kalman(cl.load(path))
        assert (
            len([name for name in controller.initial_state if "estimate" in name]) == 29 + late // 5
        )


@pytest.mark.parametrize("count", [3, 9])
def test_numbers_of_160_decades_are_refused_without_a_warning(count):
    """Warnings are errors here: SciPy's own balancing overflows, and casts what is no number."""
    small = 1e-160
    held, moved = np.eye(count, k=1) * small, np.zeros((count, 1))
    held[0, 0], moved[-1, 0] = 0.9, 1.0 / small
    with pytest.raises(NotApplicable, match="Riccati"):
        optimal_regulator(held, moved, np.eye(count), 0.0 * moved, np.eye(1))


def test_what_is_on_its_way_is_as_large_as_where_it_comes_from():
    """A pump of 0.012 m³/s moved by 0.2 fills 0.8 m² by 0.3 m in 100 s, wherever its pipe ends."""
    model = cl.load(BEHIND_A_PIPE).linear
    weights = QuadraticWeights(np.eye(3), 25.0 * np.eye(1))
    _, sizes, moves = scaled_cost(model, weights, 4.0, 100.0)
    assert moves.tolist() == [0.2]
    assert sizes[0] == pytest.approx(0.3, rel=1e-12)
    assert sizes[1] == pytest.approx(100.0 * model.A[1, 0] * 0.3, rel=1e-12)
    assert sizes[2] == max(sizes[:2])  # nothing reaches it in two steps
    assert set(sizes[3:]) == {0.2} and len(sizes) == 3 + 13


def test_inputs_that_move_nothing_leave_sizes_of_one():
    cut_off = replace(cl.load(BEHIND_A_PIPE).linear, delays=None)
    weights = QuadraticWeights(np.eye(3), np.eye(1))
    _, sizes, _ = scaled_cost(cut_off, weights, 4.0, 100.0)
    assert sizes.tolist() == [1.0] * 3
