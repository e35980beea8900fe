"""A model in the ranges of its signals, as far as they have ranges."""

from __future__ import annotations

import math

from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.pade import undisturbed
from clepsydra.linear.ranges import in_ranges


def compared(model: LinearModel) -> LinearModel | None:
    """Return the model without disturbances and in ranges, or None where that says nothing.

    A state without a range counts in the size of its value at rest, or in its unit where that
    is zero; an input or an output without a range has nothing to be compared with.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    LinearModel or None

    Examples
    --------
    A model without a process has no ranges:

    >>> import numpy as np
    >>> one = np.eye(1)
    >>> compared(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                      ("tank.level",), ("pump",), (), ("level",))) is None
    True
    """
    if model.point is None:
        return None
    process, at = model.point.process, model.point.as_dict()
    sizes = {}
    for name in model.states:
        try:
            span = process.signal(name).span
        except KeyError:  # a state of an approximated dead time, between -1 and 1
            span = math.inf
        if not (math.isfinite(span) and span > 0.0):
            sizes[name] = abs(at.get(name, 0.0)) or 1.0
    for name in (*model.inputs, *model.outputs):
        span = process.signal(name).span
        if not (math.isfinite(span) and span > 0.0):
            return None
    return in_ranges(undisturbed(model), sizes)
