"""Where dead times stand in a model: in a loop, or once between an input and an output."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.linear.linear_model import LinearModel

# Two sums of dead times that differ by this share are one.
_SAME = 1e-9


class Lags(NamedTuple):
    """G(s) = diag(e^(-s outputs)) G0(s) diag(e^(s inputs)), G0 with every dead time at zero.

    Parameters
    ----------
    inputs : ndarray [m]
    outputs : ndarray [q]
        [s]; output i follows input j by outputs_i - inputs_j.

    Examples
    --------
    >>> lags = Lags(np.array([0.0]), np.array([5.0]))
    >>> lags.outputs[0] - lags.inputs[0]
    np.float64(5.0)
    """

    inputs: np.ndarray
    outputs: np.ndarray


def delay_dependencies(model: LinearModel) -> np.ndarray:
    """Return which delayed signal [r] holds what came out of which [r], by way of the states.

    Examples
    --------
    >>> from clepsydra.linear.internal_delays import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> late = InternalDelays(np.ones(1), -one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    >>> delay_dependencies(LinearModel(0.0 * one, one, none, one, 0.0 * one, ("tank.level",),
    ...     ("pump",), (), ("level",), delays=late)).tolist()
    [[True]]
    """
    delays = model.delays
    if delays is None:
        return np.zeros((0, 0), bool)
    reached = _closure(model.A != 0.0)
    by_states = _any_way(delays.from_states != 0.0, reached)
    return _any_way(by_states, delays.to_states != 0.0) | (delays.through != 0.0)


def has_delay_in_loop(model: LinearModel) -> bool:
    """Return whether some dead time stands in a loop, so that there are infinitely many poles.

    Where none does, the poles are the eigenvalues of A exactly, whatever the dead times.

    Examples
    --------
    >>> one = np.eye(1)
    >>> has_delay_in_loop(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                               ("tank.level",), ("pump",), (), ("level",)))
    False
    """
    depends = delay_dependencies(model)
    steps = depends
    for _ in range(len(depends)):
        if np.any(np.diag(steps)):
            return True
        steps = _any_way(steps, depends)
    return False


def lags_of(model: LinearModel) -> Lags | None:
    """Return the lags by which dead times leave a model, or None where they do not.

    They do when all ways from an input to an output take the same dead time, and the ways of
    several inputs and outputs agree. Then zeros are those of the model without dead time, and
    gains are. An input that reaches no output, or an output that none reaches, has lag zero.

    Parameters
    ----------
    model : LinearModel

    Examples
    --------
    >>> one = np.eye(1)
    >>> lags_of(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                     ("tank.level",), ("pump",), (), ("level",))).outputs
    array([0.])
    """
    m, q = len(model.inputs), len(model.outputs)
    delays = model.delays
    if delays is None:
        return Lags(np.zeros(m), np.zeros(q))
    ways = _ways(model)
    count, n, r = len(ways), len(model.states), len(delays.times)
    # Only what an input moves and an output shows plays a part.
    reaches = _closure(ways)
    part = reaches[:, :m].any(axis=1) & reaches[count - q :].any(axis=0)
    weights = np.zeros(count)
    weights[m + n + r : m + n + 2 * r] = delays.times  # gained on the way into z
    lag = np.full(count, np.nan)
    tolerance = _SAME * float(delays.times.sum())
    for start in np.flatnonzero(part):
        if not np.isnan(lag[start]):
            continue
        lag[start], waiting = 0.0, [start]
        while waiting:
            node = waiting.pop()
            for other in np.flatnonzero(part & (ways[:, node] | ways[node])):
                for way, value in (
                    (ways[other, node], lag[node] + weights[other]),
                    (ways[node, other], lag[node] - weights[node]),
                ):
                    if not way:
                        continue
                    if np.isnan(lag[other]):
                        lag[other] = value
                        waiting.append(other)
                    elif abs(lag[other] - value) > tolerance:
                        return None
    lag = np.where(np.isnan(lag), 0.0, lag)
    return Lags(lag[:m], lag[count - q :])


def dead_times(model: LinearModel) -> np.ndarray:
    """Return the dead time from each input to each output, each pair by itself.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    ndarray [q, m]
        [s]; zero where the input does not move the output, not a number where ways of different
        dead time lead to it or one stands in a loop between them.

    Examples
    --------
    >>> one = np.eye(1)
    >>> dead_times(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                        ("tank.level",), ("pump",), (), ("level",)))
    array([[0.]])
    """
    found = np.zeros((len(model.outputs), len(model.inputs)))
    if model.delays is None:
        return found
    for row, output in enumerate(model.outputs):
        for column, name in enumerate(model.inputs):
            lags = lags_of(model.select([output], [name]))
            found[row, column] = np.nan if lags is None else lags.outputs[0] - lags.inputs[0]
    return found


def _ways(model: LinearModel) -> np.ndarray:
    """Return [to, from] among u [m], x [n], w [r], z [r], y [q]: what acts on what at once."""
    delays = model.delays
    assert delays is not None
    m, n, r, q = len(model.inputs), len(model.states), len(delays.times), len(model.outputs)
    u, x = slice(0, m), slice(m, m + n)
    w, z = slice(m + n, m + n + r), slice(m + n + r, m + n + 2 * r)
    y = slice(m + n + 2 * r, m + n + 2 * r + q)
    ways = np.zeros((y.stop, y.stop), bool)
    for rows, columns, matrix in (
        (x, x, model.A),
        (x, u, model.B),
        (x, z, delays.to_states),
        (w, x, delays.from_states),
        (w, u, delays.from_inputs),
        (w, z, delays.through),
        (z, w, np.eye(r)),
        (y, x, model.C),
        (y, u, model.D),
        (y, z, delays.to_outputs),
    ):
        ways[rows, columns] = np.asarray(matrix) != 0.0
    return ways


def _closure(ways: np.ndarray) -> np.ndarray:
    """Return [to, from]: where something leads, in any number of steps, none included."""
    reached = ways | np.eye(len(ways), dtype=bool)
    for _ in range(max(1, len(ways)).bit_length()):
        reached = _any_way(reached, reached)
    return reached


def _any_way(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.asarray(left.astype(int) @ right.astype(int) > 0)
