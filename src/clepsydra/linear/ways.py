"""What acts on what in a linear model: at once, or through other signals."""

from __future__ import annotations

from itertools import accumulate, pairwise

import numpy as np

from clepsydra.linear.linear_model import LinearModel


def ways(model: LinearModel) -> np.ndarray:
    """Return [to, from] among u [m], x [n], w [r], z [r], y [q]: what acts on what at once."""
    at, acts = model.ports, model.matrix != 0.0
    sizes = map(len, (model.inputs, model.states, model.times, model.times, model.outputs))
    u, x, w, z, y = (slice(*ends) for ends in pairwise([0, *accumulate(sizes)]))
    found = np.zeros((y.stop, y.stop), bool)
    for to, rows in ((x, at.x), (w, at.w), (y, at.y)):
        for start, columns in ((x, at.x), (u, at.u), (z, at.z)):
            found[to, start] = acts[rows, columns]
    found[z, w] = np.eye(len(model.times))
    return found


def in_any_steps(ways: np.ndarray) -> np.ndarray:
    """Return [to, from]: where something leads, in any number of steps, none included.

    Examples
    --------
    >>> chain = np.eye(3, k=-1, dtype=bool)  # the first acts on the second, that on the third
    >>> in_any_steps(chain)[2].tolist()
    [True, True, True]
    """
    reached = ways | np.eye(len(ways), dtype=bool)
    for _ in range(max(1, len(ways)).bit_length()):
        reached = reached @ reached
    return reached
