"""Gains of sampled linear-quadratic control, with and without integral action."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.arguments.argument import word
from clepsydra.designs.sampled.sampled_cost import SampledCost, sampled_cost
from clepsydra.designs.sampled.sampled_process import sampled_process, sampled_states
from clepsydra.designs.states.quadratic_weights import QuadraticWeights
from clepsydra.designs.states.riccati import Regulator, optimal_regulator
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.late_outputs import late_outputs
from clepsydra.linear.linear_model import LinearModel

ANTI_WINDUP = word("anti_windup", "what integrals do while an output is at a limit", AntiWindup)
_SINGULAR = 1e-10


class LqiGains(NamedTuple):
    """u(k) = −F x(k) − G w(k) for the deviation x and the sum w of the outputs, and its poles.

    Parameters
    ----------
    feedback : ndarray [m, N]
        F, [input unit / state unit]; with dead time also from what is on its way.
    integral : ndarray [m, q]
        G, [input unit / (output unit · s)].
    eigenvalues : ndarray [N + q], complex
        Of the closed loop from one sample to the next.
    cost : ndarray [N + q, N + q]
        To go, in scaled states and errors.
    sizes : ndarray [N]
        In which the states are scaled.
    """

    feedback: np.ndarray
    integral: np.ndarray
    eigenvalues: np.ndarray
    cost: np.ndarray
    sizes: np.ndarray


def lqi_gains(
    model: LinearModel, weights: QuadraticWeights, sampling_period: float, horizon: float
) -> LqiGains:
    """Return the gains that minimise the quadratic cost of the sampled model with integrators.

    The process ẋ = A x + B u, y = C x is held over each sampling period Δt. Its integrators are
    those of the step law, w(k+1) = w(k) + Δt y(k), so that the law with these gains is the
    optimal one and no approximation of it. The cost counts what x does between the samples
    (`designs.sampled.sampled_cost`). As Δt tends to zero this is the continuous LQI. With dead time
    the states of the sampled model are those of the process and what is on its way
    (`designs.sampled.sampled_process`), and the cost counts the sampling instants.

    Parameters
    ----------
    model : LinearModel
        From all manipulated inputs to the controlled outputs, without feedthrough.
    weights : QuadraticWeights
        With those of the integrals.
    sampling_period : float
        Δt [s]
    horizon : float
        About how long a response takes [s]: it scales the numbers, not the result.

    Raises
    ------
    NotApplicable
        The outputs cannot be held independently, or the Riccati equation has no stabilising
        solution; or
        the model has dead time that a sampled model cannot hold.

    References
    ----------
    G. F. Franklin, J. D. Powell and M. Workman, Digital Control of Dynamic Systems, 3rd
    edition, Addison-Wesley 1998, chapter 9.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> gains = lqi_gains(tank, QuadraticWeights(one, one, one), 1e-5, 1.0)
    >>> round(float(gains.feedback[0, 0]), 4)
    1.732
    """
    refuse_feedthrough(model)
    check_independent(model)
    assert weights.integrals is not None
    q = len(model.outputs)
    cost, sizes, moves = scaled_cost(model, weights, sampling_period, horizon)
    n = len(sizes)
    sums = 1.0 / np.sqrt(np.diag(weights.integrals))
    C = sampled_process(model, sampling_period).shown * sizes
    held = np.block(
        [[cost.held, np.zeros((n, q))], [sampling_period * C / sums[:, None], np.eye(q)]]
    )
    moved = np.vstack([cost.moved, np.zeros((q, len(moves)))])
    Q = np.zeros((n + q, n + q))
    Q[:n, :n], Q[n:, n:] = cost.Q, sums[:, None] * weights.integrals * sums
    N = np.vstack([cost.N, np.zeros((q, len(moves)))])
    found = optimal_regulator(held, moved, Q, N, cost.R)
    gain = moves[:, None] * found.gain
    F, G = gain[:, :n] / sizes, gain[:, n:] / sums
    return LqiGains(F, G, found.eigenvalues, found.cost, sizes)


def lqr_gains(
    model: LinearModel, weights: QuadraticWeights, sampling_period: float, horizon: float
) -> Regulator:
    """Return the regulator u(k) = −F x(k) that minimises the quadratic cost without integrals.

    Parameters
    ----------
    model, weights, sampling_period, horizon
        As for `lqi_gains`; the weights of integrals do not count.

    Returns
    -------
    Regulator
        Its gain is F [input unit / state unit]; its cost is in scaled states.

    Raises
    ------
    NotApplicable
        There is feedthrough, or the Riccati equation has no stabilising solution; or
        the model has dead time that a sampled model cannot hold.

    Examples
    --------
    ẋ = u with Q = R = 1, sampled fast: F = 1.

    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> round(float(lqr_gains(tank, QuadraticWeights(one, one), 1e-5, 1.0).gain[0, 0]), 4)
    1.0
    """
    refuse_feedthrough(model)
    cost, sizes, moves = scaled_cost(model, weights, sampling_period, horizon)
    found = optimal_regulator(cost.held, cost.moved, cost.Q, cost.N, cost.R)
    return found._replace(gain=moves[:, None] * found.gain / sizes)


def scaled_cost(
    model: LinearModel, weights: QuadraticWeights, period: float, horizon: float
) -> tuple[SampledCost, np.ndarray, np.ndarray]:
    """Return the sampled cost per second in scaled states and inputs, and their sizes.

    In units of what weighs one, all numbers are near one, as a Riccati solver likes it.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> cost, sizes, moves = scaled_cost(tank, QuadraticWeights(one, 0.25 * one), 1.0, 10.0)
    >>> sizes, moves  # a move of 2 goes as far as 20 in 10 s
    (array([20.]), array([2.]))
    """
    moves = 1.0 / np.sqrt(np.diag(weights.inputs))
    sizes = _state_sizes(model, moves, horizon)
    Q = sizes[:, None] * weights.states * sizes
    R = moves[:, None] * weights.inputs * moves
    if model.delays is None:
        A = model.A * sizes / sizes[:, None]
        B = model.B * moves / sizes[:, None]
        cost = sampled_cost(A, B, Q, R, period)
        of_a_second = [matrix / period for matrix in (cost.Q, cost.N, cost.R)]
        return SampledCost(cost.held, cost.moved, *of_a_second), sizes, moves
    held, moved, _ = sampled_process(model, period)
    n, N = len(model.states), len(held)
    # What is on its way is as large as where it came from.
    of_signals = dict(zip(model.states + model.inputs, [*sizes, *moves], strict=True))
    readings = np.abs(late_outputs(model).prompt.C) @ sizes
    of_signals |= dict(zip(model.outputs, readings, strict=True))
    sizes = np.array([of_signals[name] for name, _ in sampled_states(model, period)])
    whole = np.zeros((N, N))
    whole[:n, :n] = Q
    scaled = SampledCost(
        held * sizes / sizes[:, None],
        moved * moves / sizes[:, None],
        whole,
        np.zeros((N, len(moves))),
        R,
    )
    return scaled, sizes, moves


def refuse_feedthrough(model: LinearModel) -> None:
    """Refuse a model in which an input acts on a controlled output at once.

    Raises
    ------
    NotApplicable

    Examples
    --------
    >>> one = np.eye(1)
    >>> refuse_feedthrough(LinearModel(-one, one, one[:, :0], one, one, ("x",), ("u",), (), ("y",)))
    Traceback (most recent call last):
        ...
    clepsydra.designs.applicability.NotApplicable: an input acts on a controlled output \
at once.
    """
    if np.any(model.D != 0.0):
        raise NotApplicable("an input acts on a controlled output at once")


def check_independent(model: LinearModel) -> None:
    """Refuse outputs that cannot all be held: it takes full row rank of [A B; C 0].

    Raises
    ------
    NotApplicable
        There are fewer inputs than outputs, or a zero at the origin.

    Examples
    --------
    >>> one = np.eye(1)
    >>> check_independent(LinearModel(-one, one, one[:, :0], one, 0 * one,
    ...                               ("x",), ("u",), (), ("y",)))
    """
    model = at_rest(model)
    n, q = len(model.states), len(model.outputs)
    if len(model.inputs) < q:
        raise NotApplicable(
            f"{len(model.inputs)} inputs cannot hold {q} outputs at their setpoints"
        )
    system = np.block([[model.A, model.B], [model.C, np.zeros((q, len(model.inputs)))]])
    system = system / np.linalg.norm(system, axis=1, keepdims=True)
    system = system / np.maximum(np.linalg.norm(system, axis=0), np.finfo(float).tiny)
    if np.linalg.svd(system, compute_uv=False)[n + q - 1] < _SINGULAR:
        raise NotApplicable(
            "the outputs cannot be held independently: there is a zero at the origin"
        )


def slowest_time_constant(eigenvalues: np.ndarray, period: float) -> float:
    """Return the time in which the slowest mode shrinks to 1/e [s].

    Examples
    --------
    >>> round(slowest_time_constant(np.array([0.5, np.exp(-0.1)]), 2.0), 9)
    20.0
    """
    largest = float(np.max(np.abs(eigenvalues), initial=0.0))
    return -period / math.log(largest) if largest > 0.0 else 0.0


def _state_sizes(model: LinearModel, moves: np.ndarray, horizon: float) -> np.ndarray:
    """Return how far the largest moves drive each state in one horizon, never zero.

    Dead times only put that off: what a pump feeds through a pipe is driven by the pump.
    """
    model = at_rest(model)
    driven = horizon * np.abs(model.B) @ moves
    fed = horizon * np.abs(model.A - np.diag(np.diag(model.A))) @ driven
    sizes = driven + fed
    return np.where(sizes > 0.0, sizes, float(sizes.max(initial=0.0)) or 1.0)
