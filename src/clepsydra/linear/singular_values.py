"""Singular values and condition number of a model over frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.response import frequency_response


def singular_values(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return the singular values of G(jω): the gains of the strongest to the weakest direction.

    They depend on units; `in_ranges(model)` gives those that compare. There a smallest value
    below one says that some combination of outputs cannot be moved through its range.

    Parameters
    ----------
    model : LinearModel
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l, min(q, m)]
        Falling. [output unit / input unit], where all outputs and all inputs share one.

    Raises
    ------
    InputError
        A frequency is not finite or is a pole.

    Examples
    --------
    >>> A, B = -np.eye(2), np.array([[3.0, 0.0], [0.0, 4.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 2)), ("a", "b"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> singular_values(model, 0.0)
    array([[4., 3.]])
    """
    return np.asarray(np.linalg.svd(frequency_response(model, omegas), compute_uv=False))


def condition_numbers(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return the condition number of G(jω), its largest over its smallest singular value.

    Above about ten, a controller that inverts the model follows its small errors. Like the
    singular values it depends on units.

    Parameters
    ----------
    model : LinearModel
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l]
        [1]; infinite where some combination of outputs answers to no input.

    Raises
    ------
    InputError
        A frequency is not finite or is a pole.

    Examples
    --------
    >>> A, B = -np.eye(2), np.array([[3.0, 0.0], [0.0, 4.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 2)), ("a", "b"),
    ...                     ("u", "v"), (), ("y", "z"))
    >>> condition_numbers(model, 0.0).round(6)
    array([1.333333])
    """
    sizes = singular_values(model, omegas)
    largest, smallest = sizes[:, 0], sizes[:, -1]
    nothing = smallest <= np.finfo(float).eps * largest
    return np.where(nothing, np.inf, largest / np.where(nothing, 1.0, smallest))
