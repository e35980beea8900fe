"""Hankel singular values: how much each direction of the state matters from input to output."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.gramians import controllability_gramian, observability_gramian
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.stable_part import stable_part


class HankelSingularValues(NamedTuple):
    """The Hankel singular values of the part of a model that dies out.

    Parameters
    ----------
    values : ndarray [r]
        Falling, [output unit / input unit]. Leaving out all states after the k-th of a balanced
        model changes G(jω) by no more than twice the sum of the values after the k-th.
    split_off : ndarray [n - r], complex
        Poles of integrators and unstable modes [rad/s], for which there is no finite value.

    Examples
    --------
    >>> HankelSingularValues(np.array([2.0, 0.1]), np.zeros(0, complex)).values[0]
    np.float64(2.0)
    """

    values: np.ndarray
    split_off: np.ndarray


def hankel_singular_values(model: LinearModel) -> HankelSingularValues:
    """Return σ_i = √λ_i(P Q) of the stable part, P and Q its Gramians.

    They depend on the units of inputs and outputs, not on those of the states; of
    `in_ranges(model)` they compare.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    HankelSingularValues

    Raises
    ------
    InputError
        The model has dead time.

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
