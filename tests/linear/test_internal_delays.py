"""Dead time inside a model: exact responses, composition, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import control
import numpy as np
import pytest
from models_by_hand import feedback, lag, late_feedback, pure_delay, rational, series, side_by_side
from refusals import refused

from clepsydra.linear.dead_time import without_dead_time
from clepsydra.linear.linear_model import InternalDelays
from clepsydra.linear.poles import poles, time_constants
from clepsydra.linear.relative_gain_array import (
    relative_gain_array,
    relative_gain_response,
    relative_gains,
)
from clepsydra.linear.response import evaluate_transfer, frequency_response, transfer_at
from clepsydra.linear.static_gain import static_gain
from clepsydra.linear.zeros import minimum_phase, normal_rank, zeros

OMEGAS = np.geomspace(1e-3, 30.0, 41)


def random_delayed(seed: int, times=(0.7, 0.3)):
    """A model with every matrix full, also through, from disturbances and to outputs."""
    numbers = np.random.default_rng(seed)
    n, m, q, r = 3, 2, 2, len(times)
    draw = numbers.standard_normal
    base = rational(draw((n, n)) - 3 * np.eye(n), draw((n, m)), draw((q, n)), draw((q, m)))
    late = InternalDelays(
        np.array(times), draw((n, r)), draw((r, n)), draw((r, m)), np.zeros((r, 0)),
        0.3 * draw((r, r)), draw((q, r)),
    )  # fmt: skip
    return replace(base, delays=late)


def linear_fraction(model, s):
    """P11 + P12 (e^{sτ} - P22)⁻¹ P21 with P(s) from [u; z] to [y; w]."""
    d = model.delays
    P = evaluate_transfer(
        model.A, np.hstack([model.B, d.to_states]), np.vstack([model.C, d.from_states]),
        np.block([[model.D, d.to_outputs], [d.from_inputs, d.through]]), np.array([s]),
    )[0]  # fmt: skip
    q, m = model.D.shape
    inner = np.diag(np.exp(s * d.times)) - P[q:, m:]
    return P[:q, :m] + P[:q, m:] @ np.linalg.solve(inner, P[q:, :m])


def test_feedback_through_a_dead_time():
    s = 1j * OMEGAS
    found = frequency_response(late_feedback(1.3, 0.8), OMEGAS)[:, 0, 0]
    np.testing.assert_allclose(found, 1 / (s + 1.3 * np.exp(-0.8 * s)), rtol=1e-13)


@pytest.mark.parametrize("seed", range(4))
def test_response_is_the_linear_fractional_one(seed):
    model = random_delayed(seed)
    found = frequency_response(model, OMEGAS)
    expected = [linear_fraction(model, 1j * omega) for omega in OMEGAS]
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-12)


def test_selection_keeps_the_delays():
    model = random_delayed(5)
    part = model.select(outputs=["y1"], inputs=["u1", "u0"])
    whole = frequency_response(model, OMEGAS)
    np.testing.assert_allclose(
        frequency_response(part, OMEGAS), whole[:, 1:, [1, 0]], rtol=1e-13, atol=1e-14
    )


def test_series_side_by_side_and_feedback_are_matrix_algebra():
    one, two = random_delayed(6), random_delayed(7, (1.1,))
    s = 1j * OMEGAS
    first, second = transfer_at(one, s), transfer_at(two, s)
    chain = series(one, two)
    np.testing.assert_allclose(transfer_at(chain, s), second @ first, rtol=1e-10, atol=1e-11)
    closed = np.linalg.solve(np.eye(2) + second @ first, second @ first)
    np.testing.assert_allclose(transfer_at(feedback(chain), s), closed, rtol=1e-9, atol=1e-10)
    beside = transfer_at(side_by_side(one, two), s)
    np.testing.assert_allclose(beside[:, :2, :2], first, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(beside[:, 2:, 2:], second, rtol=1e-11, atol=1e-12)
    assert not beside[:, :2, 2:].any() and not beside[:, 2:, :2].any()


def test_without_delays_nothing_changes(random_system):
    system = random_system(3, 5, 2, 2)
    model = rational(system.A, system.B, system.C, system.D)
    shapes = ((5, 0), (0, 5), (0, 2), (0, 0), (0, 0), (2, 0))
    no_signals = InternalDelays(np.zeros(0), *(np.zeros(shape) for shape in shapes))
    empty = replace(model, delays=no_signals)
    assert empty.delays is None
    plain = evaluate_transfer(model.A, model.B, model.C, model.D, 1j * OMEGAS)
    np.testing.assert_array_equal(frequency_response(empty, OMEGAS), plain)


@pytest.mark.parametrize("function", [poles, zeros, time_constants, normal_rank, minimum_phase])
def test_what_needs_a_rational_model_says_so(function):
    with refused(place="linear model, delays", remedy="without_dead_time"):
        function(late_feedback(1.0, 0.5))


def test_python_control_cannot_hold_dead_time():
    with refused(remedy="without_dead_time"):
        late_feedback(1.0, 0.5).to_control()


@pytest.mark.parametrize("time", [0.0, -1.0, np.nan, np.inf])
def test_a_dead_time_must_be_one(time):
    with refused(expected="dead times above 0 s"):
        pure_delay(1.0, time)


def test_shapes_that_disagree_are_refused():
    model = late_feedback(1.0, 0.5)
    with pytest.raises(ValueError, match=r"delays\.to_states is \(2, 1\), its names make \(1, 1\)"):
        replace(model, delays=replace(model.delays, to_states=np.zeros((2, 1))))


def test_a_pole_is_refused():
    loop = series(rational(0.0, 1.0, 1.0, 0.0), pure_delay(2.0))
    with refused(expected="no pole of the model"):
        frequency_response(loop, [0.1, 0.0])


def test_static_gain():
    assert static_gain(late_feedback(2.0, 0.3))[0, 0] == pytest.approx(0.5, rel=1e-14)
    assert static_gain(series(lag(3.0, 7.0), pure_delay(2.0)))[0, 0] == pytest.approx(3.0)


def test_static_gain_of_what_was_filled_and_is_emptied_later():
    """(1 - e^{-sτ})/s has the gain τ, (1 - e^{-sτ})/s² grows as τ t."""
    tau = 3.7
    both = rational(0.0, 1.0, 1.0, 0.0)
    late = InternalDelays(
        np.array([tau]), np.array([[-1.0]]), np.zeros((1, 1)), np.eye(1), np.zeros((1, 0)),
        np.zeros((1, 1)), np.zeros((1, 1)),
    )  # fmt: skip
    model = replace(both, delays=late)
    assert static_gain(model)[0, 0] == pytest.approx(tau, rel=1e-12)
    assert static_gain(series(model, rational(0.0, 1.0, 1.0, 0.0)))[0, 0] == np.inf
    assert static_gain(series(model, rational(0.0, -1.0, 1.0, 0.0)))[0, 0] == -np.inf


def test_relative_gains_with_dead_time():
    A, B = -np.diag([0.5, 0.2]), np.array([[2.0, 1.0], [0.5, 1.5]])
    plain = rational(A, B, np.eye(2), np.zeros((2, 2)))
    late = series(pure_delay(1.0, 2.0), plain)
    np.testing.assert_allclose(relative_gains(late), relative_gains(plain), rtol=1e-13)
    omegas = [0.01, 0.3, 4.0]
    found = relative_gain_response(late, omegas)
    for array, gain in zip(found, frequency_response(late, omegas), strict=True):
        np.testing.assert_allclose(array, gain * np.linalg.pinv(gain).T, rtol=1e-11)
        np.testing.assert_allclose(array.sum(axis=0), 1.0, rtol=1e-12)
    integrating = series(pure_delay(1.0, 2.0), rational(0 * A, B, np.eye(2), np.zeros((2, 2))))
    np.testing.assert_allclose(relative_gains(integrating), relative_gain_array(B), rtol=1e-9)


def test_relative_gains_of_the_quadruple_tank_over_frequency(minimum):
    """λ(s) = 1/(1 - g12 g21/(g11 g22)), Johansson's transfer functions."""
    from clepsydra.linear.equilibrium import find_equilibrium
    from clepsydra.linear.linearise import linearise

    model = linearise(find_equilibrium(minimum.process)).select(["level_1", "level_2"])
    _, _, t3, t4 = minimum.time_constants(minimum.levels(minimum.voltage))
    g1, g2 = minimum.gamma
    omegas = np.geomspace(1e-4, 1.0, 9)
    s = 1j * omegas
    ratio = (1 - g1) * (1 - g2) / (g1 * g2 * (1 + s * t3) * (1 + s * t4))
    found = relative_gain_response(model, omegas)
    np.testing.assert_allclose(found[:, 0, 0], 1 / (1 - ratio), rtol=1e-9)


def test_a_frequency_at_which_the_response_is_singular():
    """(s² + 1)/(s + 1)² in one channel has a zero at j."""
    A = np.array([[-1.0, 1.0], [0.0, -1.0]])
    model = rational(A, np.array([[0.0], [1.0]]), np.array([[2.0, -2.0]]), 1.0)
    gain = frequency_response(model, 1.0)[0, 0, 0]
    assert abs(gain) < 1e-12
    with refused(place="ω = 1 rad/s"):
        relative_gain_response(model, [0.5, 1.0])


@pytest.mark.parametrize("order", [1, 2, 3, 4, 7, 10])
def test_pade_is_that_of_python_control(order):
    theirs = control.tf(*control.pade(1.7, order))
    ours = without_dead_time(pure_delay(1.7), order)
    np.testing.assert_allclose(
        frequency_response(ours, OMEGAS)[:, 0, 0], theirs(1j * OMEGAS), rtol=1e-7
    )
    assert ours.delays is None and len(ours.states) == order


def test_pade_inside_a_loop():
    """The rightmost roots of s + e^{-s} = 0 by Lambert's W."""
    from scipy.special import lambertw

    found = poles(without_dead_time(late_feedback(1.0, 1.0), 8))[0]
    assert found == pytest.approx(complex(lambertw(-1.0)), rel=1e-9)


def test_pade_of_a_full_model_converges():
    model = random_delayed(9)
    slow = OMEGAS[OMEGAS < 3.0]
    exact = frequency_response(model, slow)
    errors = [
        np.abs(frequency_response(without_dead_time(model, order), slow) - exact).max()
        for order in (1, 3, 6)
    ]
    assert errors[0] > 20 * errors[1] > 400 * errors[2]


def test_what_pade_refuses():
    with refused(expected="a whole number from 1 to 10"):
        without_dead_time(late_feedback(1.0, 0.5), 0)
    with refused(expected="a whole number from 1 to 10"):
        without_dead_time(late_feedback(1.0, 0.5), 2.5)
    model = replace(pure_delay(1.0), disturbances=("d",), E=np.zeros((0, 1)), delays=None)
    late = replace(pure_delay(1.0).delays, from_disturbances=np.ones((1, 1)))
    with refused(remedy="name the disturbance as an input"):
        without_dead_time(replace(model, delays=late), 2)
    echo = replace(pure_delay(1.0).delays, through=np.eye(1))
    with refused(remedy="one higher or lower"):
        without_dead_time(replace(pure_delay(1.0), delays=echo), 2)
