"""A linear model whose signals are shares of their ranges, so that its numbers compare."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.dead_time import undisturbed
from clepsydra.linear.linear_model import LinearModel


def in_ranges(model: LinearModel, sizes: Mapping[str, float] | None = None) -> LinearModel:
    """Return the model with every signal divided by its size, the width of its range.

    Singular values, condition numbers, directions of zeros and distances to uncontrollability
    depend on units; of the model in ranges they say what a full swing of an actuator does to
    the range of a sensor.

    Parameters
    ----------
    sizes : mapping, optional
        Signal name to size [unit of the signal], in place of its range or where it has none.

    Returns
    -------
    LinearModel
        Without an operating point, since its numbers are no longer in SI.

    Raises
    ------
    InputError
        A size is missing: the signal has no range with two ends, or no process is known; it is
        not above zero; or a name is unknown.

    Examples
    --------
    A pump from 0 to 10 V fills a tank 0.5 m high whose sensor gives 5 V:

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.001 * one, one[:, :0], 10.0 * one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> share = in_ranges(tank, {"tank.level": 0.5, "pump": 10.0, "level": 5.0})
    >>> share.B, share.C
    (array([[0.02]]), array([[1.]]))
    """
    known = _spans(model) | dict(sizes or {})
    names = {*model.states, *model.inputs, *model.disturbances, *model.outputs}
    for name in sizes or {}:
        if name not in names:
            raise InputError(
                "ranges, sizes", name, "a signal of the model", f"use one of {sorted(names)}"
            )
    states, inputs, disturbances, outputs = (
        np.array([_size(name, known) for name in group])
        for group in (model.states, model.inputs, model.disturbances, model.outputs)
    )
    delayed = np.ones(len(model.times))
    columns = np.concatenate([states, inputs, disturbances, delayed])
    rows = np.concatenate([states, outputs, delayed])
    return model.with_matrix(model.matrix * columns / rows[:, None], model.times, point=None)


def _spans(model: LinearModel) -> dict[str, float]:
    if model.point is None:
        return {}
    process = model.point.process
    groups = (process.state, process.inputs, process.disturbances, process.measurements)
    return {signal.name: signal.span for group in groups for signal in group}


def _size(name: str, known: Mapping[str, float]) -> float:
    size = float(known.get(name, np.inf))
    if not (np.isfinite(size) and size > 0.0):
        expected = "a range with two ends, above zero"
        remedy = "give the signal a range in the process file, or its size here"
        raise InputError(f"ranges, {name}", known.get(name), expected, remedy)
    return size


def in_known_ranges(model: LinearModel) -> LinearModel | None:
    """Return the model without disturbances and in ranges, or None where that says nothing.

    A state without a range counts in the size of its value at rest, or in its unit where that
    is zero; an input or an output without a range has nothing to be compared with.

    Returns
    -------
    LinearModel or None
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
