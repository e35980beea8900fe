"""Gains of sampled linear-quadratic control with integral action."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.design.applicability import NotApplicable
from clepsydra.design.sampled_cost import sampled_cost
from clepsydra.linear.linear_model import LinearModel

METHOD = "LQI"
_SINGULAR = 1e-10


class LqiGains(NamedTuple):
    """u(k) = −F x(k) − G w(k) for the deviation x and the sum w of the outputs, and its poles.

    Parameters
    ----------
    feedback : ndarray [m, n]
        F, [input unit / state unit].
    integral : ndarray [m, q]
        G, [input unit / (output unit · s)].
    eigenvalues : ndarray [n + q], complex
        Of the closed loop from one sample to the next.

    Examples
    --------
    >>> gains = LqiGains(np.array([[1.7]]), np.eye(1), np.array([0.5, 0.25]))
    >>> [float(abs(each)) for each in gains.eigenvalues]
    [0.5, 0.25]
    """

    feedback: np.ndarray
    integral: np.ndarray
    eigenvalues: np.ndarray


def lqi_gains(
    model: LinearModel,
    maximum_errors: np.ndarray,
    maximum_moves: np.ndarray,
    settling_horizon: float,
    sampling_period: float,
) -> LqiGains:
    """Return the gains that minimise the quadratic cost of the sampled model with integrators.

    The process ẋ = A x + B u, y = C x is held over each sampling period Δt. Its integrators are
    those of the step law, w(k+1) = w(k) + Δt y(k), so that the law with these gains is the
    optimal one and no approximation of it. With Bryson's weights, each the inverse square of
    the largest deviation that is acceptable, the cost is::

        ∫ Σ (y_j/ȳ_j)² + Σ (u_i/ū_i)² dt  +  Δt Σ_k Σ_j (w_j(k)/(ȳ_j T))²

    where T is the time for which a largest error may last. The integral counts what y does
    between the samples (`design.sampled_cost`). As Δt tends to zero this is the continuous
    LQI with the cost of w under the integral.

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
    sampling_period : float
        Δt [s]

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, or the Riccati equation has no stabilising
        solution.

    References
    ----------
    A. E. Bryson and Y.-C. Ho, Applied Optimal Control, Hemisphere 1975, section 5.2.
    G. F. Franklin, J. D. Powell and M. Workman, Digital Control of Dynamic Systems, 3rd
    edition, Addison-Wesley 1998, chapter 9.

    Examples
    --------
    ẋ = u, y = x, all deviations and T one. Sampled fast it is the continuous LQI, whose poles
    are those of s² + √3 s + 1, so F = √3 and G = 1:

    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> gains = lqi_gains(tank, np.ones(1), np.ones(1), 1.0, 1e-5)
    >>> round(float(gains.feedback[0, 0]), 4), round(float(gains.integral[0, 0]), 4)
    (1.732, 1.0)
    """
    from scipy.linalg import solve_discrete_are

    if np.any(model.D != 0.0):
        raise NotApplicable(METHOD, "an input acts on a controlled output at once")
    _check_independent(model)
    n, q = len(model.states), len(model.outputs)
    # In units of the acceptable deviations, and of the horizon for time, all numbers are near
    # one, as the solver likes it.
    moves, horizon = np.asarray(maximum_moves, float), settling_horizon
    errors, step = np.asarray(maximum_errors, float), sampling_period / settling_horizon
    sizes = _state_sizes(model, moves, horizon)
    A = horizon * model.A * sizes / sizes[:, None]
    B = horizon * model.B * moves / sizes[:, None]
    C = model.C * sizes / errors[:, None]
    cost = sampled_cost(A, B, C.T @ C, np.eye(len(moves)), step)
    held = np.block([[cost.held, np.zeros((n, q))], [step * C, np.eye(q)]])
    moved = np.vstack([cost.moved, np.zeros((q, len(moves)))])
    Q = np.block([[cost.Q, np.zeros((n, q))], [np.zeros((q, n)), step * np.eye(q)]]) / step
    N, R = np.vstack([cost.N, np.zeros((q, len(moves)))]) / step, cost.R / step
    try:
        P = solve_discrete_are(held, moved, Q, R, s=N)
    except np.linalg.LinAlgError as error:
        raise NotApplicable(
            METHOD, "the Riccati equation has no stabilising solution: a mode is out of reach"
        ) from error
    gain = np.linalg.solve(R + moved.T @ P @ moved, moved.T @ P @ held + N.T)
    eigenvalues = np.linalg.eigvals(held - moved @ gain)
    if not np.all(np.abs(eigenvalues) < 1.0):
        raise NotApplicable(METHOD, "the Riccati solution does not stabilise the model")
    gain = moves[:, None] * gain
    return LqiGains(gain[:, :n] / sizes, gain[:, n:] / (errors * horizon), eigenvalues)


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
