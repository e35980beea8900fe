"""Dead time in a linear model: where it stands, and rational models in place of it."""

from __future__ import annotations

from math import comb, factorial
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel, led_back
from clepsydra.linear.poles import integrators
from clepsydra.linear.ways import in_any_steps, ways

# Two sums of dead times that differ by this share are one.
_SAME = 1e-9
_HIGHEST_ORDER = 10
# Agrees with e^(-sτ) up to s⁶, so up to six integrators in series are counted exactly.
_ORDER_AT_THE_ORIGIN = 3


class Lags(NamedTuple):
    """G(s) = diag(e^(-s outputs)) G0(s) diag(e^(s inputs)), G0 with every dead time at zero.

    Parameters
    ----------
    inputs : ndarray [m]
    outputs : ndarray [q]
        [s]; output i follows input j by outputs_i - inputs_j.
    """

    inputs: np.ndarray
    outputs: np.ndarray


def delay_dependencies(model: LinearModel) -> np.ndarray:
    """Return which delayed signal [r] holds what came out of which [r], by way of the states."""
    delays = model.delays
    if delays is None:
        return np.zeros((0, 0), bool)
    by_states = (delays.from_states != 0.0) @ in_any_steps(model.A != 0.0)
    return np.asarray(by_states @ (delays.to_states != 0.0) | (delays.through != 0.0))


def has_delay_in_loop(model: LinearModel) -> bool:
    """Return whether some dead time stands in a loop, so that there are infinitely many poles.

    Where none does, the poles are the eigenvalues of A exactly, whatever the dead times.
    """
    depends = delay_dependencies(model)
    return bool(np.any(np.diag(depends @ in_any_steps(depends))))


def lags_of(model: LinearModel) -> Lags | None:
    """Return the lags by which dead times leave a model, or None where they do not.

    They do when all ways from an input to an output take the same dead time, and the ways of
    several inputs and outputs agree. Then zeros are those of the model without dead time, and
    gains are. An input that reaches no output, or an output that none reaches, has lag zero.
    """
    m, q = len(model.inputs), len(model.outputs)
    delays = model.delays
    if delays is None:
        return Lags(np.zeros(m), np.zeros(q))
    from scipy.sparse.csgraph import breadth_first_order

    acts = ways(model)
    count, n, r = len(acts), len(model.states), len(delays.times)
    # Only what an input moves and an output shows plays a part.
    reaches = in_any_steps(acts)
    part = np.any(reaches[:, :m], axis=1) & np.any(reaches[count - q :], axis=0)
    acts &= part & part[:, None]
    weights = np.zeros(count)
    weights[m + n + r : m + n + 2 * r] = delays.times  # gained on the way into z
    lag = np.full(count, np.nan)
    for start in np.flatnonzero(part):
        if np.isnan(lag[start]):
            lag[start] = 0.0
            order, before = breadth_first_order(acts, start, directed=False)
            for node in order[1:]:
                known = before[node]
                gained = weights[node] if acts[node, known] else -weights[known]
                lag[node] = lag[known] + gained
    to, came_from = np.nonzero(acts)
    if np.any(np.abs(lag[to] - lag[came_from] - weights[to]) > _SAME * delays.times.sum()):
        return None
    lag = np.where(np.isnan(lag), 0.0, lag)
    return Lags(lag[:m], lag[count - q :])


def dead_times(model: LinearModel) -> np.ndarray:
    """Return the dead time from each input to each output, each pair by itself.

    Returns
    -------
    ndarray [q, m]
        [s]; zero where the input does not move the output, not a number where ways of different
        dead time lead to it or one stands in a loop between them.
    """
    found = np.zeros((len(model.outputs), len(model.inputs)))
    if model.delays is None:
        return found
    for row, output in enumerate(model.outputs):
        for column, name in enumerate(model.inputs):
            lags = lags_of(model.select([output], [name]))
            found[row, column] = np.nan if lags is None else lags.outputs[0] - lags.inputs[0]
    return found


def without_dead_time(model: LinearModel, order: int) -> LinearModel:
    """Return a rational model in which each dead time is a Padé approximation.

    e^(-sτ) ≈ p(-sτ)/p(sτ), numerator and denominator of the same order: the gain is one at
    every frequency and the phase is right up to about ω = order/τ. Each dead time adds `order`
    states, and as many zeros in the right half-plane.

    Parameters
    ----------
    model : LinearModel
        Returned as it is where it has no dead time.
    order : int
        1 to 10.

    Returns
    -------
    LinearModel
        Its new states are dead_time_i.state_k, [1] beside the delayed signal.

    Raises
    ------
    InputError
        The order is out of range; a disturbance reaches an output through dead times alone,
        which the matrices of a rational `LinearModel` cannot hold; or delayed signals feed each
        other so that the approximation of this order is not well posed.

    References
    ----------
    G. H. Golub and C. F. Van Loan, Matrix Computations, 4th ed., 2013, chapter 9.

    Examples
    --------
    >>> from clepsydra.linear.linear_model import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> tank = LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",), ("pump",), (),
    ...                    ("level",), delays=late)
    >>> np.linalg.eigvals(without_dead_time(tank, 5).A)[-2:].round(4)  # s + e^(-s) = 0
    array([-0.3181+1.3372j, -0.3181-1.3372j])
    """
    delays = model.delays
    if not 1 <= order <= _HIGHEST_ORDER or order != int(order):
        raise InputError(
            "Padé approximation, order", order, "a whole number from 1 to 10", "4 serves most loops"
        )
    if delays is None:
        return model
    # Each approximation is ẋ = a x + b w, z = c x + d w, side by side in block matrices.
    a, b, c, d = _approximation(order)
    r = len(delays.times)
    rates = np.diag(1.0 / delays.times)
    if np.linalg.cond(np.eye(r) - d * delays.through) > 1e12:
        expected = "an order that makes the delayed signals well posed"
        remedy = "take the order one higher or lower"
        raise InputError("Padé approximation, order", order, expected, remedy)
    at, matrix = model.ports, model.matrix
    shown = np.kron(np.eye(r), c)
    matrix = np.hstack([matrix, matrix[:, at.z] @ shown])  # z by the approximation's states
    matrix = led_back(matrix, at.z, at.w, d * np.eye(r))
    if np.any(matrix[at.y, at.d]):
        got = "a disturbance that reaches an output through dead time alone"
        expected = "a state between each disturbance and each output"
        raise InputError("linear model, delays", got, expected, "name the disturbance as an input")
    states = np.kron(rates, b) @ matrix[at.w]
    states[:, at.z.stop :] += np.kron(rates, a)
    matrix = np.vstack([matrix[at.x], states, matrix[at.y]])
    return model.with_matrix(
        np.hstack([matrix[:, at.x], matrix[:, at.z.stop :], matrix[:, at.u.start : at.d.stop]]),
        np.zeros(0),
        states=(
            *model.states,
            *(f"dead_time_{i}.state_{k}" for i in range(1, r + 1) for k in range(1, order + 1)),
        ),
    )


def at_rest(model: LinearModel) -> LinearModel:
    """Return the model with its dead times at zero: the same where nothing moves.

    Its G(0) is that of the model. Its poles are not.

    Raises
    ------
    numpy.linalg.LinAlgError
        Delayed signals feed each other with a gain of one, so nothing holds them at rest.
    """
    delays = model.delays
    if delays is None:
        return model
    at = model.ports
    matrix = led_back(model.matrix, at.z, at.w, np.eye(len(delays.times)))
    return model.with_matrix(matrix[: at.w.start, : at.z.start], np.zeros(0))


def same_at_the_origin(model: LinearModel) -> LinearModel:
    """Return a rational model whose G(s) has the same limit, and the same growth, as s → 0.

    Where nothing integrates that is the model at rest. Where something does, the dead times
    matter even there (a tank filled now and emptied τ later by the same amount ends higher by
    τ times the flow), and a Padé approximation takes their place, whose series in s is that of
    the dead time up to s⁶.
    """
    if model.delays is None:
        return model
    size = np.eye(len(model.delays.times)) - model.delays.through
    if np.linalg.cond(size) < 1e12:
        resting = at_rest(model)
        if not integrators(resting.A):
            return resting
    return without_dead_time(undisturbed(model), _ORDER_AT_THE_ORIGIN)


def undisturbed(model: LinearModel) -> LinearModel:
    """Return the model without its disturbances, for what does not depend on them."""
    matrix = np.delete(model.matrix, model.ports.d, axis=1)
    return model.with_matrix(matrix, model.times, disturbances=())


def _approximation(order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return a state space of the Padé approximation of a dead time of one second.

    The states of its companion form are scaled by the coefficients, which keeps its entries
    near one.
    """
    weights = [  # p(s) = Σ weights[k] s^k
        comb(order, k) * factorial(2 * order - k) / factorial(2 * order) for k in range(order + 1)
    ]
    denominator = np.array(weights) / weights[-1]
    numerator = denominator * (-1.0) ** np.arange(order + 1)
    direct = float(numerator[-1])
    a = np.eye(order, k=1)
    a[-1] = -denominator[:-1]
    b = np.zeros((order, 1))
    b[-1] = 1.0
    c = (numerator - direct * denominator)[:-1][None, :]
    sizes = 1.0 / denominator[:-1]
    return sizes[:, None] ** -1 * a * sizes, b / sizes[:, None], c * sizes, direct
