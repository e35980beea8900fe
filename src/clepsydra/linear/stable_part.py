"""The part of a linear model that dies out, split off from what does not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.internal_delays import refuse_delays
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import integrators, origin_radius, rightmost_first


class StablePart(NamedTuple):
    """G(s) = C (s I - A)⁻¹ B + D + what does not die out.

    Parameters
    ----------
    A, B, C : ndarray [r, r], [r, m], [q, r]
        All eigenvalues of A in the left half-plane; its states are mixed and have no names.
    others : ndarray [n - r], complex
        The poles that were split off [rad/s], integrators among them as zero.

    Examples
    --------
    >>> one = np.eye(1)
    >>> StablePart(-one, one, one, np.zeros(0, complex)).A
    array([[-1.]])
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    others: np.ndarray


def stable_part(model: LinearModel) -> StablePart:
    """Split off integrators and unstable modes, exactly, by a change of basis.

    The ordered Schur form puts the stable modes first; a Sylvester equation removes what
    couples the others to them. A mode at the origin counts as not stable up to √ε of the
    fastest rate where several stand there, since rounding spreads those.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    StablePart

    Raises
    ------
    InputError
        The model has dead time.

    Examples
    --------
    A tank with an outlet beside one without:

    >>> B = np.ones((2, 1))
    >>> model = LinearModel(np.diag([0.0, -0.02]), B, B[:, :0], np.eye(2), np.zeros((2, 1)),
    ...                     ("a", "b"), ("u",), (), ("y", "z"))
    >>> stable_part(model).A, stable_part(model).others.real
    (array([[-0.02]]), array([0.]))
    """
    from scipy.linalg import schur, solve_sylvester

    refuse_delays(model.delays, "stable parts")
    n, count = len(model.A), integrators(model.A)
    if not n:
        return StablePart(model.A, model.B, model.C, np.zeros(0, complex))
    rates = np.linalg.eigvals(model.A)
    at_origin = np.sort(np.abs(rates))[:count]
    radius = max(origin_radius(model.A), 2.0 * float(at_origin.max(initial=0.0)))

    def dies_out(real: float, imaginary: float) -> bool:
        return real < -radius if abs(complex(real, imaginary)) > radius else False

    form, basis, r = schur(model.A, output="real", sort=dies_out)
    A, coupling, rest = form[:r, :r], form[:r, r:], form[r:, r:]
    # With x₁ = v + X x₂ the modes no longer meet: A X - X rest = -coupling.
    X = solve_sylvester(A, -rest, -coupling) if 0 < r < n else np.zeros((r, n - r))
    B, C = basis.T @ model.B, model.C @ basis
    others = np.linalg.eigvals(rest)
    others[np.argsort(np.abs(others))[:count]] = 0.0
    return StablePart(A, B[:r] - X @ B[r:], C[:, :r], rightmost_first(others))
