"""How far a process moves from one rest to another, by its linear model."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.residence_times import width_of_range

#: What is missed of what is wanted, as a share, where the inputs cannot hold it at all.
_MISSED = 1e-6


def moves_at_rest(model: LinearModel, wanted: np.ndarray) -> dict[str, float] | None:
    """Return how far states and inputs move by name; None where the inputs cannot hold it.

    A Δx + B Δu and C Δx + D Δu are solved for together, so that a process that integrates, and
    has no static gain, needs no other route. Of several solutions it is the smallest in shares of
    the ranges.

    Parameters
    ----------
    model : LinearModel
        Without dead time.
    wanted : ndarray [n + q]
        What both are to be.

    Examples
    --------
    >>> import clepsydra as cl
    >>> moves = moves_at_rest(cl.load("three-tanks").linear, np.array([0.0, 0.0, 0.0, 0.01]))
    >>> round(moves["tank_3.level"], 9)
    0.01
    """
    process, names = operating_point_of(model).process, (*model.states, *model.inputs)
    sizes = np.array([width_of_range(process.signal(name)) for name in names])
    matrix = np.block([[model.A, model.B], [model.C, model.D]]) * sizes
    rows = np.max(np.abs(matrix), axis=1)
    rows[rows == 0.0] = 1.0
    shares = np.linalg.lstsq(matrix / rows[:, None], wanted / rows, rcond=None)[0]
    missed = np.max(np.abs(matrix @ shares - wanted) / rows)
    if missed > _MISSED * np.max(np.abs(wanted / rows), initial=np.finfo(float).tiny):
        return None
    return dict(zip(names, (shares * sizes).tolist(), strict=True))
