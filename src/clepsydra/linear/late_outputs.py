"""Outputs of a linear model that are told later than they are."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.linear.linear_model import LinearModel
from clepsydra.process.process import Process


def reading_ages(process: Process) -> dict[str, float]:
    """Return how old what controllers see of a measurement is, where it is no reading of now [s].

    A dead time is what it is. Of a sensor that reports every N samples a controller sees readings
    that are 0 to N - 1 samples old, (N - 1)/2 on the average, which is the delay that the hold
    between reports has at frequencies well below that of the reports: half its time, less the half
    sample that the hold of the controller itself stands for in any sampled model.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> reading_ages(load_process("quadruple-tank"))
    {}
    """
    period = process.sampling_period
    ages = {
        name: each.samples(period).mean_age * period for name, each in process.reporting.items()
    }
    return {name: age for name, age in ages.items() if age > 0.0}


class LateOutputs(NamedTuple):
    """A model apart from how late its outputs are told.

    Parameters
    ----------
    prompt : LinearModel
        The model whose outputs are told at once.
    ages : dict
        Output to how old it is when it is told [s].
    """

    prompt: LinearModel
    ages: dict[str, float]


@lru_cache(maxsize=16)
def late_outputs(model: LinearModel) -> LateOutputs:
    """Return a model with its late outputs told at once, and how late they are.

    Late is an output that shows one delayed signal and nothing else, which only states make and
    which acts on nothing: what `with_late_outputs` puts before it.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> found = late_outputs(with_late_outputs(tank, {"level": 40.0}))
    >>> found.ages, found.prompt.C, found.prompt.times
    ({'level': 40.0}, array([[1.]]), array([], dtype=float64))
    """
    late = model.delays
    if late is None or not late.to_outputs.any():
        return LateOutputs(model, {})
    beside = (late.to_states, late.through, late.through.T, late.from_inputs.T)
    inner = np.asarray(np.vstack([*beside, late.from_disturbances.T]).any(axis=0))
    at, matrix = model.ports, model.matrix.copy()
    ages: dict[str, float] = {}
    apart: list[int] = []
    for row, shown in enumerate(late.to_outputs):
        places = np.flatnonzero(shown)
        told = len(places) == 1 and not inner[places[0]] and shown[places[0]] == 1.0
        if told and not (model.C[row].any() or model.D[row].any()):
            (place,) = places.tolist()
            matrix[at.y.start + row] = matrix[at.w.start + place]
            ages[model.outputs[row]] = float(late.times[place])
            apart.append(place)
    kept = np.delete(np.arange(len(late.times)), apart)
    rows = [*range(at.w.start), *(at.w.start + kept)]
    columns = [*range(at.z.start), *(at.z.start + kept)]
    return LateOutputs(model.with_matrix(matrix[np.ix_(rows, columns)], late.times[kept]), ages)


def with_late_outputs(model: LinearModel, ages: Mapping[str, float]) -> LinearModel:
    """Return a model some of whose outputs are what they were some time ago.

    Each such output is a delayed signal of its own, which leaves as y and comes back as y later.

    Parameters
    ----------
    model : LinearModel
        Without a disturbance that acts on an output directly.
    ages : mapping
        Output to how old it is [s].

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-one, one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> late = with_late_outputs(tank, {"level": 40.0})
    >>> late.times, late.C
    (array([40.]), array([[0.]]))
    """
    late = [place for place, name in enumerate(model.outputs) if name in ages]
    if not late:
        return model
    at, matrix = model.ports, model.matrix
    rows = at.y.start + np.array(late)
    told = matrix[rows]
    matrix = np.vstack([matrix, told])
    matrix[rows] = 0.0
    back = np.zeros((len(matrix), len(late)))
    back[rows, np.arange(len(late))] = 1.0
    times = [ages[model.outputs[place]] for place in late]
    return model.with_matrix(np.hstack([matrix, back]), np.array([*model.times, *times]))


def words_on_late_readings(process: Process) -> list[str]:
    """Return sentences on the measurements that controllers do not see at once.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> words_on_late_readings(load_process("quadruple-tank"))
    []
    """
    ages = reading_ages(process)
    return [
        f"{name} {reporting.words}, and the last report is held: its value is on average "
        f"{time_text(ages.get(name, 0.0))} old, which is the dead time that designs count."
        if reporting.sampling
        else f"{name} is {reporting.words} when a controller sees it."
        for name, reporting in process.reporting.items()
    ]
