"""Zeros with their directions, singular values, and signals in their ranges."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest
from models_by_hand import late_feedback, pure_delay, rational, series
from refusals import refused

import clepsydra as cl
from clepsydra.linear.directionality import condition_numbers, singular_values
from clepsydra.linear.directions import zero_directions
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.response import evaluate_transfer, frequency_response
from clepsydra.linear.zeros import zeros

DEAD_TIME = Path(__file__).parents[1] / "dead-time.toml"


def plant(johansson):
    return linearise(find_equilibrium(johansson.process)).select(["level_1", "level_2"])


def test_zero_directions_of_the_quadruple_tank(johansson):
    """G(z) u = 0 and yᴴ G(z) = 0; from Johansson (13): y1/y2 = -g21(z)/g11(z) and so on."""
    model = plant(johansson)
    found = zero_directions(model)
    np.testing.assert_allclose([item.zero for item in found], johansson.zeros(
        johansson.levels(johansson.voltage)), rtol=1e-9)  # fmt: skip
    for zero, inputs, outputs in found:
        gain = evaluate_transfer(model.A, model.B, model.C, model.D, np.array([zero]))[0]
        size = np.linalg.norm(gain, 2)
        assert np.linalg.norm(gain @ inputs) < 1e-9 * size
        assert np.linalg.norm(outputs.conj() @ gain) < 1e-9 * size
        assert np.linalg.norm(inputs) == pytest.approx(1.0) == np.linalg.norm(outputs)
        expected = -gain[1, 0] / gain[0, 0]
        assert outputs[0].conj() / outputs[1].conj() == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("seed", range(6))
def test_zero_directions_of_random_models(seed, random_system):
    system = random_system(seed, 5, 2, 2, direct=bool(seed % 2))
    model = rational(system.A, 1e-4 * system.B, 1e3 * system.C, 0.1 * system.D)
    found = zero_directions(model)
    assert len(found) == (5 if seed % 2 else 3)
    for zero, inputs, outputs in found:
        gain = evaluate_transfer(model.A, model.B, model.C, model.D, np.array([zero]))[0]
        assert np.linalg.norm(gain @ inputs) < 1e-8 * np.linalg.norm(gain)
        assert np.linalg.norm(outputs.conj() @ gain) < 1e-8 * np.linalg.norm(gain)


def test_a_zero_that_is_a_pole_as_well():
    """diag((s - 1)/(s + 1), (s + 1)/(s + 2)...): the zero at -1 is a pole of the other channel."""
    A, B = np.diag([-1.0, -2.0]), np.diag([-2.0, -1.0])
    found = zero_directions(rational(A, B, np.eye(2), np.eye(2)))
    assert [round(item.zero.real, 9) for item in found] == [1.0, -1.0]
    np.testing.assert_allclose(found[0].input_direction, [1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(found[1].input_direction, [0.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(found[1].output_direction, [0.0, 1.0], atol=1e-9)


@pytest.mark.parametrize("rounded", [0.0, 2e-15])
def test_a_zero_that_stands_twice_has_two_directions(rounded, monkeypatch):
    """Also where its two values differ by what the linear algebra rounds."""
    module = importlib.import_module("clepsydra.linear.directions")
    monkeypatch.setattr(
        module, "zeros", lambda model: zeros(model) * [1.0 - rounded, 1.0 + rounded]
    )
    A, B = -2.0 * np.eye(2), -3.0 * np.eye(2)
    found = zero_directions(rational(A, B, np.eye(2), np.eye(2)))
    assert [round(item.zero.real, 9) for item in found] == [1.0, 1.0]
    assert abs(np.vdot(found[0].input_direction, found[1].input_direction)) < 1e-9


def test_dead_time_is_refused():
    with refused(remedy="without_dead_time"):
        zero_directions(late_feedback(1.0, 0.5))


def test_singular_values_and_condition_number(johansson):
    model = series(pure_delay(3.0, 5.0), plant(johansson))
    omegas = np.geomspace(1e-4, 1.0, 7)
    found, numbers = singular_values(model, omegas), condition_numbers(model, omegas)
    for gain, sizes, number in zip(frequency_response(model, omegas), found, numbers, strict=True):
        squares = np.linalg.eigvalsh(gain.conj().T @ gain)[::-1]
        np.testing.assert_allclose(sizes, np.sqrt(squares), rtol=1e-7)
        assert number == pytest.approx(np.linalg.cond(gain), rel=1e-9)
    # A dead time in each input turns the phase only.
    plain = singular_values(plant(johansson), omegas)
    np.testing.assert_allclose(found, plain, rtol=1e-10)


def test_condition_number_of_a_singular_model():
    model = rational(-np.eye(1), [[1.0, 2.0]], [[1.0], [3.0]], np.zeros((2, 2)))
    assert condition_numbers(model, 0.1)[0] == np.inf


def test_condition_number_where_nothing_answers():
    # Both singular values are zero: no direction answers, so none is a finite multiple.
    nothing = rational(-np.eye(1), [[0.0, 0.0]], [[1.0], [3.0]], np.zeros((2, 2)))
    np.testing.assert_array_equal(singular_values(nothing, 0.1), [[0.0, 0.0]])
    np.testing.assert_array_equal(condition_numbers(nothing, [0.1, 1.0]), [np.inf, np.inf])


def test_in_ranges(minimum):
    model = plant(minimum)
    share = in_known_ranges(model)
    # Tanks of 0.2 m, pumps and sensors of 10 V.
    np.testing.assert_allclose(share.A, model.A, rtol=1e-14)
    np.testing.assert_allclose(share.B, model.B * 10 / 0.2, rtol=1e-14)
    np.testing.assert_allclose(share.C, model.C * 0.2 / 10, rtol=1e-14)
    assert share.point is None
    np.testing.assert_allclose(zeros(share), zeros(model), rtol=1e-9)


def test_in_ranges_with_dead_time():
    plant = cl.load(DEAD_TIME)
    share, omegas = in_known_ranges(plant.linear), np.geomspace(1e-4, 1.0, 5)
    # The feed has a range of 8 l/min, the sensor one of 50 cm.
    factor = 8e-3 / 60.0 / 0.5
    response = frequency_response(plant.linear, omegas)
    np.testing.assert_allclose(frequency_response(share, omegas), factor * response, rtol=1e-12)


def test_in_ranges_without_a_range():
    assert in_known_ranges(late_feedback(1.0, 1.0)) is None
