"""Gains of linear-quadratic control with integral action."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.design.applicability import NotApplicable
from clepsydra.linear.linear_model import LinearModel

METHOD = "LQI"
_SINGULAR = 1e-10


class LqiGains(NamedTuple):
    """u = −F x − G ∫y dt for the deviations x and y, and the poles it gives.

    Parameters
    ----------
    feedback : ndarray [m, n]
        F, [input unit / state unit].
    integral : ndarray [m, q]
        G, [input unit / (output unit · s)].
    poles : ndarray [n + q], complex
        Of the closed loop [rad/s].
    """

    feedback: np.ndarray
    integral: np.ndarray
    poles: np.ndarray


def lqi_gains(
    model: LinearModel,
    maximum_errors: np.ndarray,
    maximum_moves: np.ndarray,
    settling_horizon: float,
) -> LqiGains:
    """Return the gains that minimise the quadratic cost of the model with integrators.

    With ẋ = A x + B u, ż = C x, and Bryson's weights, each the inverse square of the largest
    deviation that is acceptable::

        ∫ Σ (y_j/ȳ_j)² + Σ (z_j/(ȳ_j T))² + Σ (u_i/ū_i)² dt

    where T is the time for which a largest error may last.

    Parameters
    ----------
    model : LinearModel
        From all manipulated inputs to the controlled outputs, without feedthrough.
    maximum_errors : ndarray [q]
        ȳ [output unit]
    maximum_moves : ndarray [m]
        ū [input unit]
    settling_horizon : float
        T [s]

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, or the Riccati equation has no stabilising
        solution.

    References
    ----------
    A. E. Bryson and Y.-C. Ho, Applied Optimal Control, Hemisphere 1975, section 5.2.

    Examples
    --------
    ẋ = u, y = x, all deviations and T one: s² + √3 s + 1, so F = √3 and G = 1.

    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> gains = lqi_gains(tank, np.ones(1), np.ones(1), 1.0)
    >>> round(float(gains.feedback[0, 0]), 6), round(float(gains.integral[0, 0]), 6)
    (1.732051, 1.0)
    """
    from scipy.linalg import solve_continuous_are

    if np.any(model.D != 0.0):
        raise NotApplicable(METHOD, "an input acts on a controlled output at once")
    _check_independent(model)
    n, q = len(model.states), len(model.outputs)
    A = np.block([[model.A, np.zeros((n, q))], [model.C, np.zeros((q, q))]])
    B = np.vstack([model.B, np.zeros((q, len(model.inputs)))])
    # In units of the acceptable deviations all numbers are near one, as the solver likes it.
    moves, horizon = np.asarray(maximum_moves, float), settling_horizon
    state_sizes = _state_sizes(model, moves, horizon)
    sizes = np.concatenate([state_sizes, np.asarray(maximum_errors, float) * horizon])
    A = horizon * A * sizes / sizes[:, None]
    B = horizon * B * moves / sizes[:, None]
    shown = np.hstack([model.C * state_sizes, np.zeros((q, q))]) / maximum_errors[:, None]
    Q = shown.T @ shown
    Q[n:, n:] += np.eye(q)
    R = np.eye(len(moves))
    try:
        P = solve_continuous_are(A, B, Q, R)
    except np.linalg.LinAlgError as error:
        raise NotApplicable(
            METHOD, "the Riccati equation has no stabilising solution: a mode is out of reach"
        ) from error
    gain = B.T @ P
    poles = np.linalg.eigvals(A - B @ gain) / horizon
    if not np.all(poles.real < 0.0):
        raise NotApplicable(METHOD, "the Riccati solution does not stabilise the model")
    gain = moves[:, None] * gain / sizes
    return LqiGains(gain[:, :n], gain[:, n:], poles)


def _check_independent(model: LinearModel) -> None:
    """Integral action needs full row rank of [A B; C 0]: no zero at the origin."""
    n, q = len(model.states), len(model.outputs)
    if len(model.inputs) < q:
        raise NotApplicable(
            METHOD, f"{len(model.inputs)} inputs cannot hold {q} outputs at their setpoints"
        )
    system = np.block([[model.A, model.B], [model.C, np.zeros((q, len(model.inputs)))]])
    system = system / np.linalg.norm(system, axis=1, keepdims=True)
    system = system / np.maximum(np.linalg.norm(system, axis=0), np.finfo(float).tiny)
    if np.linalg.svd(system, compute_uv=False)[n + q - 1] < _SINGULAR:
        raise NotApplicable(
            METHOD, "the outputs cannot be held independently: there is a zero at the origin"
        )


def _state_sizes(model: LinearModel, moves: np.ndarray, horizon: float) -> np.ndarray:
    """Return how far the largest moves drive each state in one horizon, never zero."""
    driven = horizon * np.abs(model.B) @ moves
    fed = horizon * np.abs(model.A - np.diag(np.diag(model.A))) @ driven
    sizes = driven + fed
    return np.where(sizes > 0.0, sizes, max(float(sizes.max(initial=0.0)), np.finfo(float).tiny))
