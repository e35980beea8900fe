"""Linear models in series and in feedback, dead times included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.internal_delays import InternalDelays, no_delays
from clepsydra.linear.linear_model import LinearModel


def series(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return second · first: the outputs of the first are the inputs of the second, in order.

    Parameters
    ----------
    first, second : LinearModel

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
        raise InputError(
            "series connection",
            f"{len(first.outputs)} outputs ({', '.join(first.outputs)})",
            f"{len(second.inputs)}, one for each of {', '.join(second.inputs)}",
            "select as many outputs of the first model as the second has inputs",
        )
    one, two = _delays_of(first), _delays_of(second)
    return LinearModel(
        A=_lower(first.A, second.B @ first.C, second.A),
        B=np.vstack([first.B, second.B @ first.D]),
        E=_side_by_side(first.E, second.E),
        C=np.hstack([second.D @ first.C, second.C]),
        D=second.D @ first.D,
        states=first.states + second.states,
        inputs=first.inputs,
        disturbances=first.disturbances + second.disturbances,
        outputs=second.outputs,
        delays=InternalDelays(
            times=np.concatenate([one.times, two.times]),
            to_states=_lower(one.to_states, second.B @ one.to_outputs, two.to_states),
            from_states=_lower(one.from_states, two.from_inputs @ first.C, two.from_states),
            from_inputs=np.vstack([one.from_inputs, two.from_inputs @ first.D]),
            from_disturbances=_side_by_side(one.from_disturbances, two.from_disturbances),
            through=_lower(one.through, two.from_inputs @ one.to_outputs, two.through),
            to_outputs=np.hstack([second.D @ one.to_outputs, two.to_outputs]),
        ),
    )


def parallel_channels(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return both models side by side: the inputs, states and outputs of one, then the other.

    Parameters
    ----------
    first, second : LinearModel

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> parallel_channels(tank, tank).A.diagonal()
    array([-0.02, -0.02])
    """
    one, two = _delays_of(first), _delays_of(second)
    delayed = {
        name: _side_by_side(getattr(one, name), getattr(two, name))
        for name in (
            "to_states",
            "from_states",
            "from_inputs",
            "from_disturbances",
            "through",
            "to_outputs",
        )
    }
    return LinearModel(
        A=_side_by_side(first.A, second.A),
        B=_side_by_side(first.B, second.B),
        E=_side_by_side(first.E, second.E),
        C=_side_by_side(first.C, second.C),
        D=_side_by_side(first.D, second.D),
        states=first.states + second.states,
        inputs=first.inputs + second.inputs,
        disturbances=first.disturbances + second.disturbances,
        outputs=first.outputs + second.outputs,
        delays=InternalDelays(np.concatenate([one.times, two.times]), **delayed),
    )


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
    factor = np.eye(size) + loop.D @ closed
    if size and np.linalg.cond(factor) > 1e14:
        raise InputError(
            "feedback, D",
            loop.D.tolist(),
            "a loop whose direct gain is not -1",
            "the loop is not well posed: change the gain or count the lag of the actuator",
        )
    outputs = np.linalg.inv(factor)  # y = outputs (C x + D r + to_outputs z)
    back = closed @ outputs  # u = r - back (C x + D r + to_outputs z)
    passed = np.eye(size) - back @ loop.D
    late = _delays_of(loop)
    return LinearModel(
        A=loop.A - loop.B @ back @ loop.C,
        B=loop.B @ passed,
        E=loop.E,
        C=outputs @ loop.C,
        D=outputs @ loop.D,
        states=loop.states,
        inputs=loop.inputs,
        disturbances=loop.disturbances,
        outputs=loop.outputs,
        delays=InternalDelays(
            times=late.times,
            to_states=late.to_states - loop.B @ back @ late.to_outputs,
            from_states=late.from_states - late.from_inputs @ back @ loop.C,
            from_inputs=late.from_inputs @ passed,
            from_disturbances=late.from_disturbances,
            through=late.through - late.from_inputs @ back @ late.to_outputs,
            to_outputs=outputs @ late.to_outputs,
        ),
    )


def require_square(loop: LinearModel) -> int:
    """Return the number of channels of a loop; raise InputError where L is not square.

    Examples
    --------
    >>> one = np.eye(1)
    >>> require_square(LinearModel(0.0 * one, one, one[:, :0], one, 0.0 * one,
    ...                            ("level",), ("error",), (), ("level",)))
    1
    """
    if len(loop.inputs) != len(loop.outputs):
        raise InputError(
            "loop",
            f"{len(loop.outputs)} outputs and {len(loop.inputs)} inputs",
            "as many outputs as inputs",
            "give the loop transfer plant · controller or controller · plant",
        )
    return len(loop.inputs)


def _delays_of(model: LinearModel) -> InternalDelays:
    if model.delays is not None:
        return model.delays
    return no_delays(
        len(model.states), len(model.inputs), len(model.disturbances), len(model.outputs)
    )


def _side_by_side(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return _lower(first, np.zeros((len(second), first.shape[1])), second)


def _lower(first: np.ndarray, across: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return [[first, 0], [across, second]]."""
    return np.block([[first, np.zeros((len(first), second.shape[1]))], [across, second]])
