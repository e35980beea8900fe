"""Transmission zeros: closed forms, known zeros, and zeros that must not appear."""

from __future__ import annotations

import control
import numpy as np
import pytest
import scipy.linalg

from clepsydra import LinearModel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.response import evaluate_transfer
from clepsydra.linear.zeros import minimum_phase, normal_rank, zeros


def model_of(A, B, C, D):
    names = [tuple(f"{kind}{i}" for i in range(size)) for kind, size in
             (("x", len(A)), ("u", B.shape[1]), ("y", len(C)))]  # fmt: skip
    empty = np.zeros((len(A), 0))
    return LinearModel(*map(np.asarray, (A, B, empty, C, D)), names[0], names[1], (), names[2])


def quadruple(plant):
    return linearise(find_equilibrium(plant.process))


def near(found, expected, tolerance=1e-9):
    """Compare two sets of roots whatever their order."""
    assert len(found) == len(expected)
    rest = list(found)
    for root in expected:
        place = int(np.argmin(np.abs(np.array(rest) - root)))
        assert abs(rest.pop(place) - root) <= tolerance * abs(root)


def test_quadruple_tank_equals_the_closed_form(johansson):
    model = quadruple(johansson).select(outputs=["level_1", "level_2"])
    expected = johansson.zeros(johansson.levels(johansson.voltage))
    np.testing.assert_allclose(zeros(model), expected, rtol=1e-9)


def test_phases(minimum, nonminimum):
    for plant, expected in ((minimum, True), (nonminimum, False)):
        model = quadruple(plant).select(outputs=["level_1", "level_2"])
        assert minimum_phase(model) is expected
    # Johansson prints zeros of -0.060, -0.018 and -0.057, +0.013 for his linearisations.
    assert zeros(model)[0].real == pytest.approx(0.013, abs=5e-4)


def test_single_elements_have_no_zeros(johansson):
    model = quadruple(johansson)
    for output in ("level_1", "level_2", "level_3", "level_4"):
        for name in ("pump_1", "pump_2"):
            assert len(zeros(model.select([output], [name]))) == 0


def test_all_sensors_leave_no_zero(johansson):
    assert len(zeros(quadruple(johansson))) == 0


@pytest.mark.parametrize("seed", range(20))
def test_sections_of_known_zeros_in_series_in_a_random_basis(seed):
    # Each section is (s - z)/(s + p) = 1 - (z + p)/(s + p), or 1/(s + p): relative degree 1 to 6.
    numbers = np.random.default_rng(seed)
    n, count = 6, seed % 6
    known, rates = numbers.uniform(-3, 3, count), numbers.uniform(0.1, 5, n)
    A, B, C, D = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n)), np.ones((1, 1))
    for k in numbers.permutation(n):
        direct, residue = (1.0, -(known[k] + rates[k])) if k < count else (0.0, 1.0)
        A[k], B[k] = C[0], D[0]
        A[k, k] -= rates[k]
        C, D = direct * C, direct * D
        C[0, k] += residue
    T = np.linalg.qr(numbers.standard_normal((n, n)))[0]
    near(zeros(model_of(T @ A @ T.T, T @ B, C @ T.T, D)), known, 1e-8)


@pytest.mark.parametrize("seed", range(10))
def test_square_random_systems_against_the_pencil(random_system, seed):
    system = random_system(seed, 7, 3, 3, direct=bool(seed % 2))
    A, B, C, D = system.A, system.B, system.C, system.D
    pencil = np.block([[A, B], [C, D]])
    unit = scipy.linalg.block_diag(np.eye(7), np.zeros((3, 3)))
    every = scipy.linalg.eigvals(pencil, unit)
    # 7 zeros with D, 7 - 3 = 4 with D = 0 and C B of full rank; the rest are at infinity.
    finite = every[np.argsort(np.abs(every))][: 7 if seed % 2 else 4]
    near(zeros(model_of(A, B, C, D)), finite, 1e-7)
    if not seed % 2:
        theirs = control.ss(A, B, C, D).zeros()
        near(zeros(model_of(A, B, C, D)), theirs[np.abs(theirs) < 1e6], 1e-7)


@pytest.mark.parametrize("seed", range(10))
def test_at_a_zero_the_response_loses_rank(random_system, seed):
    system = random_system(seed, 6, 2, 2)
    found = zeros(model_of(system.A, system.B, system.C, system.D))
    assert len(found) == 4
    response = evaluate_transfer(system.A, system.B, system.C, system.D, found)
    elsewhere = evaluate_transfer(system.A, system.B, system.C, system.D, found + 1)
    smallest = np.linalg.svd(response, compute_uv=False)
    assert np.all(smallest[:, 1] < 1e-10 * smallest[:, 0])
    away = np.linalg.svd(elsewhere, compute_uv=False)
    assert np.all(away[:, 1] > 1e-4 * away[:, 0])


@pytest.mark.parametrize("shape", [(2, 3), (3, 2), (1, 4), (4, 1)])
def test_a_random_system_that_is_not_square_has_none(random_system, shape):
    system = random_system(11, 6, shape[1], shape[0])
    assert len(zeros(model_of(system.A, system.B, system.C, system.D))) == 0


def test_a_common_zero_of_a_system_that_is_not_square():
    # (s - 2)/((s + 1)(s + 3)) and the same over (s + 4): a tall system with one zero.
    A = np.array([[-4, -3, 0], [1, 0, 0], [1, -2, -4]], float)
    B = np.array([[1.0], [0], [0]])
    C = np.array([[1, -2, 0], [0, 0, 1]], float)
    near(zeros(model_of(A, B, C, np.zeros((2, 1)))), [2.0])
    near(zeros(model_of(A.T, C.T, B.T, np.zeros((1, 2)))), [2.0])


def test_zero_first_markov_parameter_gives_no_large_spurious_zero():
    # 1/(s + 1)³ in a basis that hides that C B and C A B vanish.
    A = -np.eye(3) + np.diag([1.0, 1.0], 1)
    B, C = np.array([[0.0], [0.0], [1.0]]), np.array([[1.0, 0.0, 0.0]])
    T = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    assert len(zeros(model_of(T @ A @ T.T, T @ B, C @ T.T, np.zeros((1, 1))))) == 0


@pytest.mark.parametrize("seed", range(5))
def test_idle_states_are_no_zeros(random_system, seed):
    core = random_system(seed, 4, 2, 2)
    other = random_system(seed + 50, 4, 2, 2)
    A = scipy.linalg.block_diag(core.A, other.A[:2, :2], other.A[2:, 2:])
    A[4:6, :4] = other.B.T @ other.A  # driven, but not shown
    A[:4, 6:] = other.C.T[:, :2]  # shows, but is not driven
    B, C = np.vstack([core.B, other.B]), np.hstack([core.C, other.C])
    B[6:], C[:, 4:6] = 0, 0
    T = np.linalg.qr(np.random.default_rng(seed).standard_normal((8, 8)))[0]
    found = zeros(model_of(T @ A @ T.T, T @ B, C @ T.T, core.D))
    near(found, zeros(model_of(core.A, core.B, core.C, core.D)), 1e-7)


def test_units_do_not_matter(minimum):
    model = quadruple(minimum).select(outputs=["level_1", "level_2"])
    units = np.diag([1e6, 1e-5, 1e3, 1.0])
    scaled = model_of(
        units @ model.A @ np.linalg.inv(units),
        units @ model.B * [1e-7, 1e4],
        np.diag([1e5, 1e-4]) @ model.C @ np.linalg.inv(units),
        model.D,
    )
    np.testing.assert_allclose(zeros(scaled), zeros(model), rtol=1e-9)


def test_two_sensors_on_one_tank_have_rank_one():
    # G = [1; 2] [1, 1] (s + 5)/(s + 1): rank one, and one zero of that rank.
    one = np.ones((1, 1))
    model = model_of(
        -one, np.ones((1, 2)), np.array([[4.0], [8.0]]), np.array([[1.0, 1.0], [2.0, 2.0]])
    )
    assert normal_rank(model) == 1
    near(zeros(model), [-5.0])
    assert minimum_phase(model) is False


def test_full_normal_rank(johansson):
    assert normal_rank(quadruple(johansson)) == 2
    assert normal_rank(quadruple(johansson).select(outputs=["level_1"])) == 1


def test_integrators_do_not_count_but_a_zero_at_the_origin_does():
    one = np.ones((1, 1))
    integrator = model_of(0 * one, one, one, 0 * one)
    assert minimum_phase(integrator) is True
    washout = model_of(-one, one, -one, one)  # s/(s + 1)
    assert abs(zeros(washout)[0]) < 1e-12
    assert minimum_phase(washout) is False


def test_a_zero_on_the_imaginary_axis_is_not_minimum_phase():
    # (s² + 4)/(s + 1)²: its inverse rings for ever.
    A, B = np.array([[-2.0, -1.0], [1.0, 0.0]]), np.array([[1.0], [0.0]])
    model = model_of(A, B, np.array([[-2.0, 3.0]]), np.ones((1, 1)))
    near(zeros(model), [2j, -2j])
    assert minimum_phase(model) is False


def test_a_model_without_dynamics_has_no_zeros():
    none = np.zeros((0, 0))
    model = model_of(none, np.zeros((0, 2)), np.zeros((2, 0)), np.eye(2))
    assert len(zeros(model)) == 0
    assert minimum_phase(model) is True
