"""The frequency response of a linear model."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel

#: Above so many states a model is brought into triangular form first.
_LARGE = 100


def frequency_response(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return G(jω) = C (jω I - A)⁻¹ B + D at each frequency, exact with dead time.

    Parameters
    ----------
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
    return transfer_at(model, 1j * frequencies)


def transfer_at(model: LinearModel, points: np.ndarray) -> np.ndarray:
    """Return G(s) of a model, with its dead times, at each complex s.

    The states and the delayed signals z = e^(-sτ) w are solved for together, so a pole of the
    model without its dead times is no obstacle. Points far in the left half-plane, where e^(-sτ)
    overflows, are not meant.

    Parameters
    ----------
    points : ndarray [l]
        Values of s [rad/s].

    Returns
    -------
    ndarray [l, q, m], complex

    Examples
    --------
    A tank whose outflow answers to its level 1 s later, 1/(s + e^(-s)), at rest:

    >>> from clepsydra.linear.linear_model import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> tank = LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",), ("pump",), (),
    ...                    ("level",), delays=late)
    >>> transfer_at(tank, np.array([0.0])).real
    array([[[1.]]])
    """
    points = np.asarray(points)
    delays = model.delays
    if delays is None:
        return evaluate_transfer(model.A, model.B, model.C, model.D, points)
    # [[s I - A, -to_states], [-e^(-sτ) from_states, I - e^(-sτ) through]] [x; z] = [[B], [e^(-sτ)
    # from_inputs]] u: the roots of the determinant are the poles.
    at, open_loop = model.ports, np.delete(model.matrix, model.ports.y, axis=0)
    n, r = len(model.A), len(model.times)
    late = np.ones((len(points), n + r, 1), complex)
    late[:, n:, 0] = np.exp(-points[:, None] * model.times)
    matrix = -late * np.delete(open_loop, slice(at.u.start, at.d.stop), axis=1)
    matrix[:, :n, :n] += points[:, None, None] * np.eye(n)
    matrix[:, n:, n:] += np.eye(r)
    inner = _solved(matrix, late * open_loop[:, at.u], points)
    return np.asarray(np.hstack([model.C, delays.to_outputs]) @ inner + model.D)


def evaluate_transfer(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Return C (s I - A)⁻¹ B + D at each complex s.

    Parameters
    ----------
    A, B, C, D : ndarray [..., n, n], [..., n, m], [..., q, n], [..., q, m]
        Of one model, or stacks of several.
    points : ndarray [..., l]
        Values of s [rad/s].

    Returns
    -------
    ndarray [..., l, q, m], complex

    Examples
    --------
    The integrator 3/s at s = 2:

    >>> one = np.eye(1)
    >>> evaluate_transfer(0.0 * one, 3.0 * one, one, 0.0 * one, np.array([2.0])).real
    array([[[1.5]]])
    """
    points = np.asarray(points)
    if A.shape[-1] <= _LARGE:
        each = np.broadcast_shapes((*A.shape[:-2], 1), points.shape)
        pencils = np.empty((*each, *A.shape[-2:]), np.result_type(A, points))
        pencils[...] = -A[..., None, :, :]
        np.einsum("...ii->...i", pencils)[...] += points[..., None]  # s I, in place
        inner = _solved(pencils, B[..., None, :, :], points)
        return np.asarray(C[..., None, :, :] @ inner + D[..., None, :, :])
    if A.ndim == 2:
        return _by_triangle(A, B, C, points) + D
    stacks = zip(A, B, C, D, points, strict=True)
    return np.stack([evaluate_transfer(*each) for each in stacks])


def _by_triangle(A: np.ndarray, B: np.ndarray, C: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return C (s I - A)⁻¹ B at each s, [l, q, m], from one Schur form A = Q T Qᴴ.

    Each point then takes n² operations in place of n³, and n numbers in place of n²: a model that
    holds hundreds of samples on their way is asked for at hundreds of frequencies.
    """
    from scipy.linalg import schur

    T, Q = schur(A, output="complex")
    beside = points[:, None] - np.diag(T)
    if not beside.all():
        raise _at_pole(points[np.argmin(np.abs(beside).min(axis=1))])
    driven, n = Q.conj().T @ B, len(A)
    inner = np.empty((n, B.shape[1], len(points)), complex)
    for row in range(n - 1, -1, -1):
        follows = np.tensordot(T[row, row + 1 :], inner[row + 1 :], axes=1)
        inner[row] = (driven[row][:, None] + follows) / beside[:, row]
    return np.asarray(np.tensordot(C @ Q, inner, axes=1).transpose(2, 0, 1))


def _solved(pencils: np.ndarray, driven: np.ndarray, points: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(pencils, driven)
    except np.linalg.LinAlgError:
        raise _at_pole(points.flat[np.argmin(np.linalg.matrix_rank(pencils))]) from None


def _at_pole(point: complex) -> InputError:
    expected = "a value that is no pole of the model"
    remedy = "evaluate beside the pole; an integrating tank has no gain at frequency zero"
    return InputError("frequency response, s", complex(point), expected, remedy)
