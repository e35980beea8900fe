"""A loop L = (A, B, C, D) judged by its state space, where the program goes by responses."""

import numpy as np

from clepsydra.linear.frequency_peak import SensitivityPeak, largest_gain
from clepsydra.linear.poles import origin_radius, rightmost_first


def closed_loop_poles(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray):
    """Return the poles of the loop closed by negative unity feedback, rightmost first."""
    return rightmost_first(np.linalg.eigvals(A - B @ np.linalg.solve(np.eye(len(D)) + D, C)))


def is_stable(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray):
    """Tell whether the loop closed by negative unity feedback is asymptotically stable."""
    well_posed = np.linalg.cond(np.eye(len(D)) + D) < 1e14
    if not well_posed:
        return False
    closed = A - B @ np.linalg.solve(np.eye(len(D)) + D, C)
    return bool(np.all(closed_loop_poles(A, B, C, D).real < -origin_radius(closed)))


def maximum_sensitivity(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray):
    """Return the peak over frequency of σ_max of S = (I + L)⁻¹."""
    if not is_stable(A, B, C, D):
        return SensitivityPeak(float("inf"), float("nan"))
    inverse = np.linalg.inv(np.eye(len(D)) + D)
    # S is itself a state space: ẋ = (A - B V C) x + B V r, e = -V C x + V r with V = (I + D)⁻¹.
    return largest_gain(A - B @ inverse @ C, B @ inverse, -inverse @ C, inverse)
