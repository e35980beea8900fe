"""The frequency response of a linear model."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel


def frequency_response(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return G(jω) = C (jω I - A)⁻¹ B + D at each frequency.

    Parameters
    ----------
    model : LinearModel
    omegas : array_like [l]
        Frequencies [rad/s]; one number is taken as a list of one.

    Returns
    -------
    ndarray [l, q, m], complex
        From the manipulated inputs to the outputs [output unit / input unit].

    Raises
    ------
    InputError
        A frequency is not finite, or is a pole of the model (zero for a tank that integrates).

    Examples
    --------
    A tank with a time constant of 50 s and a gain of 2, at its corner frequency:

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> frequency_response(tank, 0.02)[0, 0, 0]
    np.complex128(1-1j)
    """
    frequencies = np.atleast_1d(np.asarray(omegas, float))
    for frequency in frequencies:
        if not np.isfinite(frequency):
            raise InputError(
                "frequency response, omegas", frequency, "finite frequencies [rad/s]", "remove it"
            )
    return evaluate_transfer(model.A, model.B, model.C, model.D, 1j * frequencies)


def evaluate_transfer(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Return C (s I - A)⁻¹ B + D at each complex s.

    Parameters
    ----------
    A, B, C, D : ndarray [n, n], [n, m], [q, n], [q, m]
    points : ndarray [l]
        Values of s [rad/s].

    Returns
    -------
    ndarray [l, q, m], complex

    Raises
    ------
    InputError
        One of the values is a pole.

    Examples
    --------
    The integrator 3/s at s = 2:

    >>> one = np.eye(1)
    >>> evaluate_transfer(0.0 * one, 3.0 * one, one, 0.0 * one, np.array([2.0])).real
    array([[[1.5]]])
    """
    pencils = np.asarray(points)[:, None, None] * np.eye(len(A)) - A
    try:
        inner = np.linalg.solve(pencils, np.broadcast_to(B, (len(pencils), *B.shape)))
    except np.linalg.LinAlgError:
        at_pole = next(s for s in points if np.linalg.matrix_rank(s * np.eye(len(A)) - A) < len(A))
        raise InputError(
            "frequency response, s",
            complex(at_pole),
            "a value that is no pole of the model",
            "evaluate beside the pole; an integrating tank has no gain at frequency zero",
        ) from None
    return np.asarray(C @ inner + D)
