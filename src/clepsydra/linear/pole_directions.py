"""Poles with the directions in which inputs reach them and outputs show them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import poles
from clepsydra.linear.zero_directions import unit_direction

_ROUNDING = 1e-12


class PoleDirection(NamedTuple):
    """A pole p, its mode among the states, and its directions.

    Parameters
    ----------
    pole : complex
        [rad/s]
    mode : ndarray [n], complex
        How the states move together, A mode = p mode; of length one.
    input_direction : ndarray [m], complex
        The combination of inputs that moves the mode most; zero where none does.
    output_direction : ndarray [q], complex
        What the outputs show of the mode; zero where they show nothing.

    Examples
    --------
    >>> one = np.ones(1)
    >>> PoleDirection(-0.5 + 0j, one, one, one).pole
    (-0.5+0j)
    """

    pole: complex
    mode: np.ndarray
    input_direction: np.ndarray
    output_direction: np.ndarray


def pole_directions(model: LinearModel) -> list[PoleDirection]:
    """Return each pole with its directions Bᴴ q and C t, t and q its right and left eigenvector.

    Directions are of length one with the largest entry positive. They depend on units:
    `in_ranges(model)` gives those that compare. Of a pole that stands several times the
    directions are one choice among many.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    list of PoleDirection
        The rightmost pole first.

    Raises
    ------
    InputError
        The model has dead time: it may have infinitely many poles.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    4.4.

    Examples
    --------
    Two tanks side by side, each with its own pump:

    >>> A, B = np.diag([-0.02, -0.01]), np.eye(2)
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 2)), ("a", "b"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> slow = pole_directions(model)[0]
    >>> slow.pole.real, slow.input_direction.real.tolist()
    (-0.01, [0.0, 1.0])
    """
    from scipy.linalg import eig
    from scipy.optimize import linear_sum_assignment

    exact = poles(model)  # refuses dead time, and has integrators at the origin
    if not len(exact):
        return []
    rates, left, right = eig(model.A, left=True, right=True)
    _, order = linear_sum_assignment(np.abs(exact[:, None] - rates))
    found = []
    for pole, place in zip(exact, order, strict=True):
        reached = model.B.T @ left[:, place]
        shown = model.C @ right[:, place]
        reached[np.abs(reached) <= _ROUNDING * np.linalg.norm(model.B)] = 0.0
        shown[np.abs(shown) <= _ROUNDING * np.linalg.norm(model.C)] = 0.0
        found.append(
            PoleDirection(
                complex(pole),
                unit_direction(right[:, place]),
                unit_direction(reached),
                unit_direction(shown),
            )
        )
    return found
