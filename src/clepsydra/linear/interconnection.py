"""Linear models in series and in feedback, dead times included."""

from __future__ import annotations

from collections.abc import Sequence, Sized

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel, led_back


def series(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return second · first: the outputs of the first are the inputs of the second, in order.

    Returns
    -------
    LinearModel
        From the inputs of the first to the outputs of the second, without an operating point.

    Raises
    ------
    InputError
        The first has another number of outputs than the second has inputs.

    Examples
    --------
    Two tanks in a row have the static gain 2 · 2:

    >>> from clepsydra.linear.static_gain import static_gain
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> static_gain(series(tank, tank))
    array([[4.]])
    """
    if len(first.outputs) != len(second.inputs):
        got = f"{len(first.outputs)} outputs ({', '.join(first.outputs)})"
        expected = f"{len(second.inputs)}, one for each of {', '.join(second.inputs)}"
        remedy = "select as many outputs of the first model as the second has inputs"
        raise InputError("series connection", got, expected, remedy)
    joined, m, q = parallel_channels(first, second), len(first.inputs), len(first.outputs)
    at = joined.ports
    passed = np.eye(len(joined.inputs), len(joined.outputs), k=-m)  # u₂ = y₁
    passed[:, q:] = 0.0
    matrix = led_back(joined.matrix, at.u, at.y, passed)
    matrix = np.delete(matrix, slice(at.y.start, at.y.start + q), axis=0)
    matrix = np.delete(matrix, slice(at.u.start + m, at.u.stop), axis=1)
    return joined.with_matrix(matrix, joined.times, inputs=first.inputs, outputs=second.outputs)


def parallel_channels(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return both models side by side: the inputs, states and outputs of one, then the other."""
    one, two = first.matrix, second.matrix
    matrix = np.zeros(np.add(one.shape, two.shape))
    matrix[: len(one), : one.shape[1]], matrix[len(one) :, one.shape[1] :] = one, two
    # Sorted by their kind: the states of both, then what follows them.
    both = (first, second)
    rows = _order([(m.states, m.outputs, m.times) for m in both])
    columns = _order([(m.states, m.inputs, m.disturbances, m.times) for m in both])
    kinds = ("states", "inputs", "disturbances", "outputs")
    return first.with_matrix(
        matrix[np.ix_(rows, columns)],
        np.concatenate([first.times, second.times]),
        **{kind: getattr(first, kind) + getattr(second, kind) for kind in kinds},
        point=None,
    )


def _order(models: Sequence[tuple[Sized, ...]]) -> np.ndarray:
    kinds = [np.repeat(range(len(groups)), [len(each) for each in groups]) for groups in models]
    return np.argsort(np.concatenate(kinds), kind="stable")


def feedback(loop: LinearModel, channels: Sequence[int] | None = None) -> LinearModel:
    """Return a loop L closed by negative unity feedback, T = (I + L)⁻¹ L, in some channels.

    Channel i leads from output i back to input i. In the channels that stay open the result is
    what the broken loop shows while the others are closed.

    Parameters
    ----------
    loop : LinearModel
        As many outputs as inputs.
    channels : sequence of int, optional
        Those to close; all where left out.

    Returns
    -------
    LinearModel
        From the setpoints (named as the inputs of L) to the outputs.

    Raises
    ------
    InputError
        L is not square, or the loop is not well posed: I + D is singular.

    Examples
    --------
    3/s has its closed-loop pole at -3:

    >>> one = np.eye(1)
    >>> loop = LinearModel(0.0 * one, 3.0 * one, one[:, :0], one, 0.0 * one,
    ...                    ("level",), ("error",), (), ("level",))
    >>> feedback(loop).A
    array([[-3.]])
    """
    size = require_square(loop)
    closed = np.zeros((size, size))
    for channel in range(size) if channels is None else channels:
        closed[channel, channel] = 1.0
    if size and np.linalg.cond(np.eye(size) + loop.D @ closed) > 1e14:
        expected = "a loop whose direct gain is not -1"
        remedy = "the loop is not well posed: change the gain or count the lag of the actuator"
        raise InputError("feedback, D", loop.D.tolist(), expected, remedy)
    at = loop.ports
    return loop.with_matrix(led_back(loop.matrix, at.u, at.y, -closed), loop.times, point=None)


def require_square(loop: LinearModel) -> int:
    """Return the number of channels of a loop; raise InputError where L is not square."""
    if len(loop.inputs) != len(loop.outputs):
        got = f"{len(loop.outputs)} outputs and {len(loop.inputs)} inputs"
        remedy = "give the loop transfer plant · controller or controller · plant"
        raise InputError("loop", got, "as many outputs as inputs", remedy)
    return len(loop.inputs)
