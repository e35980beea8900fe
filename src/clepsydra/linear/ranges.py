"""A linear model whose signals are shares of their ranges, so that its numbers compare."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.linear.dead_time import undisturbed
from clepsydra.linear.linear_model import LinearModel


def in_known_ranges(model: LinearModel) -> LinearModel | None:
    """Return the model with every signal divided by the width of its range; None without ranges.

    Singular values, condition numbers, directions of zeros and distances to uncontrollability
    depend on units; of the model in ranges they say what a full swing of an actuator does to
    the range of a sensor. A state without a range counts in the size of its value at rest, or in
    its unit where that is zero; an input or an output without a range has nothing to be compared
    with. Disturbances are left out.

    Returns
    -------
    LinearModel or None
        Without an operating point, since its numbers are no longer in SI.

    Examples
    --------
    Pumps and sensors from 0 to 10 V, tanks 0.2 m high:

    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").linear
    >>> float(in_known_ranges(model).B[0, 0] / model.B[0, 0])
    50.0
    """
    if model.point is None:
        return None
    process, at, model = model.point.process, model.point.as_dict(), undisturbed(model)
    signals = (*process.state, *process.inputs, *process.disturbances, *process.measurements)
    spans = {s.name: s.span for s in signals if math.isfinite(s.span) and s.span > 0.0}
    if not spans.keys() >= {*model.inputs, *model.outputs}:
        return None
    # An approximated dead time has states between -1 and 1, which are no signals.
    states = [spans.get(name) or abs(at.get(name, 0.0)) or 1.0 for name in model.states]
    inputs, outputs = ([spans[name] for name in names] for names in (model.inputs, model.outputs))
    delayed = [1.0] * len(model.times)
    columns, rows = np.array([*states, *inputs, *delayed]), np.array([*states, *outputs, *delayed])
    return model.with_matrix(model.matrix * columns / rows[:, None], model.times, point=None)
