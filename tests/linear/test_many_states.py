"""Models of hundreds of states, as dead time over many samples makes them, at many frequencies."""

import tracemalloc

import numpy as np
import pytest
from refusals import refused

from clepsydra.linear.response import evaluate_transfer

LATE = 150


def delay_line(samples: int) -> tuple[np.ndarray, ...]:
    """Return A, B, C and D of y(k) = u(k - samples)."""
    A = np.diag(np.ones(samples - 1), -1)
    B, C = np.eye(samples)[:, :1], np.eye(samples)[-1:]
    return A, B, C, np.zeros((1, 1))


def test_a_long_delay_turns_the_phase_and_nothing_else():
    """G(z) = z^-150, exactly."""
    angles = np.linspace(0.001, np.pi, 400)
    found = evaluate_transfer(*delay_line(LATE), np.exp(1j * angles))[:, 0, 0]
    assert np.allclose(found, np.exp(-1j * LATE * angles), rtol=0.0, atol=1e-12)


def test_two_inputs_and_three_outputs_stand_in_their_places():
    """Lags side by side, 1/(s + a), each from its own input to its own output."""
    rates = np.geomspace(1e-4, 1e2, LATE)
    B, C = np.zeros((LATE, 2)), np.zeros((3, LATE))
    B[[10, 140], [0, 1]] = C[[0, 2], [10, 140]] = 1.0
    D = np.array([[0.0, 0.0], [0.0, 3.0], [0.0, 0.0]])
    points = 1j * np.geomspace(1e-5, 1e3, 50)
    found = evaluate_transfer(-np.diag(rates), B, C, D, points)
    expected = np.broadcast_to(D, (50, 3, 2)).astype(complex).copy()
    expected[:, 0, 0] = 1.0 / (points + rates[10])
    expected[:, 2, 1] = 1.0 / (points + rates[140])
    assert np.allclose(found, expected, rtol=1e-12, atol=0.0)


def test_a_frequency_costs_as_many_numbers_as_the_model_has_states():
    """2,000 matrices of 150 times 150 complex numbers are 720 MB."""
    points = np.exp(1j * np.linspace(0.001, np.pi, 2000))
    tracemalloc.start()
    try:
        evaluate_transfer(*delay_line(LATE), points)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 100e6


@pytest.mark.parametrize("samples", [3, LATE])
def test_a_pole_is_refused_with_the_point(samples):
    with refused(place="frequency response, s", value=0j):
        evaluate_transfer(*delay_line(samples), np.array([1.0, 0.0]))
