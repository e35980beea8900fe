"""Linear models built by hand for the tests, with dead time and without."""

from __future__ import annotations

import numpy as np

from clepsydra import LinearModel
from clepsydra.linear.linear_model import InternalDelays


def rational(A, B, C, D) -> LinearModel:
    A, B, C, D = (np.atleast_2d(np.asarray(matrix, float)) for matrix in (A, B, C, D))
    n, m, q = len(A), B.shape[1], len(C)
    if A.size == 0:
        n, A, B, C = 0, np.zeros((0, 0)), np.zeros((0, m)), np.zeros((q, 0))
    return LinearModel(
        A, B, np.zeros((n, 0)), C, D,
        tuple(f"x{i}" for i in range(n)), tuple(f"u{i}" for i in range(m)), (),
        tuple(f"y{i}" for i in range(q)),
    )  # fmt: skip


def static(D) -> LinearModel:
    D = np.atleast_2d(np.asarray(D, float))
    return rational(np.zeros((0, 0)), np.zeros((0, D.shape[1])), np.zeros((len(D), 0)), D)


def pure_delay(*times: float) -> LinearModel:
    """One channel for each dead time."""
    r = len(times)
    one, none = np.eye(r), np.zeros
    late = InternalDelays(
        np.array(times), none((0, r)), none((r, 0)), one, none((r, 0)), none((r, r)), one
    )
    names = tuple(f"delayed_{i}" for i in range(r))
    return LinearModel(
        none((0, 0)), none((0, r)), none((0, 0)), none((r, 0)), none((r, r)),
        (), names, (), names, delays=late,
    )  # fmt: skip


def lag(gain: float, time_constant: float) -> LinearModel:
    return rational(-1.0 / time_constant, gain / time_constant, 1.0, 0.0)


def pi(gain: float, integral_time: float) -> LinearModel:
    return rational(0.0, 1.0, gain / integral_time, gain)


def late_feedback(k: float, tau: float, gain: float = 1.0) -> LinearModel:
    """gain/(s + k e^(-s τ)), the dead time inside."""
    one, none = np.eye(1), np.zeros((1, 0))
    late = InternalDelays(np.array([tau]), -k * one, one, 0 * one, none, 0 * one, 0 * one)
    return LinearModel(
        0 * one, gain * one, none, one, 0 * one, ("h",), ("u",), (), ("y",), delays=late
    )
