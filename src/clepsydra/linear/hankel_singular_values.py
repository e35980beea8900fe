"""Hankel singular values: how much each direction of the state matters from input to output."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.linear_model import LinearModel, refuse_delays
from clepsydra.linear.poles import integrators, origin_radius, rightmost_first


class StablePart(NamedTuple):
    """G(s) = C (s I - A)⁻¹ B + D + what does not die out.

    Parameters
    ----------
    A, B, C : ndarray [r, r], [r, m], [q, r]
        All eigenvalues of A in the left half-plane; its states are mixed and have no names.
    others : ndarray [n - r], complex
        The poles that were split off [rad/s], integrators among them as zero.
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


def controllability_gramian(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Return P = ∫ e^(At) B Bᵀ e^(Aᵀt) dt from zero to infinity, from A P + P Aᵀ + B Bᵀ = 0.

    Parameters
    ----------
    A, B : ndarray [n, n], [n, m]
        All eigenvalues of A in the left half-plane; see `stable_part`.

    Returns
    -------
    ndarray [n, n]
        Symmetric. xᵀ P⁻¹ x is the least ∫|u|² dt that leads from zero to the state x.

    Examples
    --------
    >>> controllability_gramian(np.array([[-0.5]]), np.array([[2.0]]))
    array([[4.]])
    """
    from scipy.linalg import solve_continuous_lyapunov

    gramian = solve_continuous_lyapunov(A, -B @ B.T) if len(A) else np.zeros((0, 0))
    return np.asarray((gramian + gramian.T) / 2.0)


def observability_gramian(A: np.ndarray, C: np.ndarray) -> np.ndarray:
    """Return Q = ∫ e^(Aᵀt) Cᵀ C e^(At) dt from zero to infinity.

    Parameters
    ----------
    A, C : ndarray [n, n], [q, n]
        All eigenvalues of A in the left half-plane; see `stable_part`.

    Returns
    -------
    ndarray [n, n]
        Symmetric. xᵀ Q x is ∫|y|² dt from the state x without inputs.
    """
    return controllability_gramian(A.T, C.T)


class HankelSingularValues(NamedTuple):
    """The Hankel singular values of the part of a model that dies out.

    Parameters
    ----------
    values : ndarray [r]
        Falling, [output unit / input unit]. Leaving out all states after the k-th of a balanced
        model changes G(jω) by no more than twice the sum of the values after the k-th.
    split_off : ndarray [n - r], complex
        Poles of integrators and unstable modes [rad/s], for which there is no finite value.
    """

    values: np.ndarray
    split_off: np.ndarray


def hankel_singular_values(model: LinearModel) -> HankelSingularValues:
    """Return σ_i = √λ_i(P Q) of the stable part, P and Q its Gramians.

    They depend on the units of inputs and outputs, not on those of the states; of
    `in_known_ranges(model)` they compare.

    References
    ----------
    K. Glover, All optimal Hankel-norm approximations of linear multivariable systems and their
    L∞-error bounds, International Journal of Control 39(6), 1984, 1115-1193,
    doi 10.1080/00207178408933239.

    Examples
    --------
    A tank with gain 2 has the one value 2/2:

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> hankel_singular_values(tank).values.round(9)
    array([1.])
    """
    part = stable_part(model)
    reached = _root(controllability_gramian(part.A, part.B))
    shown = _root(observability_gramian(part.A, part.C))
    values = np.linalg.svd(shown.T @ reached, compute_uv=False) if len(part.A) else np.zeros(0)
    return HankelSingularValues(values, part.others)


def _root(gramian: np.ndarray) -> np.ndarray:
    """Return R of R Rᵀ = M for a symmetric M without negative eigenvalues but for rounding."""
    sizes, directions = np.linalg.eigh(gramian)
    return np.asarray(directions * np.sqrt(np.maximum(sizes, 0.0)))
