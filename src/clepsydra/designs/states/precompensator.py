"""The precompensator: the gain from setpoints to inputs that makes the outputs follow at rest."""

from __future__ import annotations

import numpy as np

from clepsydra.designs.applicability import NotApplicable

_SINGULAR = 1e-10


def precompensator(
    held: np.ndarray,
    moved: np.ndarray,
    controlled: np.ndarray,
    feedback: np.ndarray,
    moves: np.ndarray,
) -> np.ndarray:
    """Return N of u = −F x + N r with which y = r at rest.

    H = C (I − Φ + Γ F)⁻¹ Γ is the static gain of the loop from N r, so N = H⁻¹. With more
    inputs than outputs N is the smallest of those with H N = I, each input counted in its
    largest acceptable move.

    Parameters
    ----------
    held, moved, controlled : ndarray [N, N], [N, m], [q, N]
        Φ, Γ and C.
    feedback : ndarray [m, N]
        F, stabilising.
    moves : ndarray [m]
        Largest acceptable moves [input unit].

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently.

    Examples
    --------
    x⁺ = 0.5 x + u, y = 2 x and F = 0.25: at rest y = 2 N r / 0.75.

    >>> one = np.eye(1)
    >>> float(precompensator(0.5 * one, one, 2 * one, 0.25 * one, np.ones(1))[0, 0])
    0.375
    """
    closed = np.eye(len(held)) - held + moved @ feedback
    gain = (controlled @ np.linalg.solve(closed, moved)) * moves
    lengths = np.linalg.norm(gain, axis=1, keepdims=True)
    if not np.all(lengths > 0.0) or len(moves) < len(gain):
        raise NotApplicable("an output does not follow any input")
    if np.linalg.svd(gain / lengths, compute_uv=False)[-1] < _SINGULAR:
        raise NotApplicable(
            "the outputs cannot be held independently: there is a zero at the origin"
        )
    inverse: np.ndarray = moves[:, None] * np.linalg.pinv(gain / lengths) / lengths.T
    return inverse
