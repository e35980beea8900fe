"""The continuous system with the same gains as a sampled one."""

from __future__ import annotations

import numpy as np


def continuous_image(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the system of s = (z − 1)/(z + 1).

    The unit circle goes to the imaginary axis, so that every gain stays; so do the Hankel
    singular values and the coprime factors.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
        No eigenvalue of A is −1.

    Examples
    --------
    >>> one = np.eye(1)
    >>> continuous_image(0.0 * one, one, one, one)[0]
    array([[-1.]])
    """
    identity = np.eye(len(A))
    inverse = np.linalg.inv(A + identity)
    root = np.sqrt(2.0)
    return (A - identity) @ inverse, root * inverse @ B, root * C @ inverse, D - C @ inverse @ B
