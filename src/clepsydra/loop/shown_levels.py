"""Levels as a run shows them: what a step takes too much from an emptied tank is no level."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.process.process import Process


def shown_levels(process: Process, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the levels of a run [m], none of them a little below its floor.

    An integration step may take more from a tank than there was, by its error. The contents keep
    it, so that balances close, and are filled up by what flows in next; the level is at the floor.
    Farther below it than a thousandth of its height a tank has been drawn from, which is told as
    harm.

    Parameters
    ----------
    values : mapping
        Every level to its trajectory [m].

    Examples
    --------
    >>> import clepsydra as cl
    >>> process = cl.load("quadruple-tank").process
    >>> found = {name: np.array([1e-3, -1e-9, -1e-2]) for name in process.levels}
    >>> shown_levels(process, found)["tank_1.level"].tolist()
    [0.001, 0.0, -0.01]
    """
    found = {}
    for signal in process.state:
        if signal.name in process.levels:
            column = np.asarray(values[signal.name], float)
            room = EMPTY_SHARE * signal.span if signal.has_range else 0.0
            below = (column < signal.low) & (column >= signal.low - room)
            found[signal.name] = np.where(below, signal.low, column)
    return found
