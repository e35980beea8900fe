"""What many plants of one kind hold at rest, as their motion has it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clepsydra.engine.many_points import at_many_points
from clepsydra.process.motion import Motion

Array = NDArray[np.float64]


def motions_at_rest(
    motion: Motion, state: Array, inputs: Array, disturbances: Array, parameters: Array
) -> list[Array]:
    """Return `Motion.at_rest` of many plants, along a last axis [·, plants] of each array.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("three-tanks")
    >>> p = np.tile(process.parameter_values[:, None], 2)
    >>> contents, *_ = motions_at_rest(
    ...     process.motion, np.full((3, 2), 0.1), np.zeros((1, 2)), np.zeros((1, 2)), p)
    >>> contents[0]  # of a tank with straight walls it is the level [m]
    array([0.1, 0.1])
    """
    contents = at_many_points(motion.to_contents, [state, parameters])
    count = state.shape[1]
    initial = np.array([signal.initial for signal in motion.memories])
    memories = np.tile(initial[:, None], (1, count))
    delayed = np.zeros((len(motion.delays), count))
    held = [contents, delayed, memories, inputs, disturbances, parameters]
    for _ in motion.delays:  # one delay may feed the next
        held[1] = at_many_points(motion.rates, held, 1)
    return held
