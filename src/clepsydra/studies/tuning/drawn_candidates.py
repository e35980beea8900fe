"""What candidates of one controller come to on drawn plants, all on the same ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.loop.loop import Loop
from clepsydra.loop.loop_batch import BatchRun, LoopBatch
from clepsydra.loop.many_plants import ManyPlants
from clepsydra.studies.robustness.drawn_scores import Happening, happened_in, judged_names
from clepsydra.studies.tuning.objective import Goal

Truths = NDArray[np.bool_]

#: Loops that run side by side, and samples of all of them together, about. What comes of a loop
#: depends on neither.
_FEWEST, _MOST, _SAMPLES = 256, 8192, 2**25
#: A disturbance that differs from plant to plant is an array of all samples of each.
_DISTURBANCE = 16
#: What makes a plant one on which a controller fails.
FAILURES = (
    Happening.OVERFLOW,
    Happening.DRY,
    Happening.HARM,
    Happening.UNSTABLE,
    Happening.UNSOLVED,
)


class DrawnRuns(NamedTuple):
    """What came of candidates on plants.

    Parameters
    ----------
    scores : dict
        "score[signal]" to its values [candidates, plants].
    failures : dict
        What makes a plant one on which a candidate fails, to where that happened, likewise.
    """

    scores: dict[str, np.ndarray]
    failures: dict[Happening, Truths]

    @property
    def failed(self) -> Truths:
        """Where a candidate fails [candidates, plants]."""
        return np.logical_or.reduce([*self.failures.values()])


class DrawnCandidates:
    """Candidates times plants as the lanes of one kernel; no trajectory is stored.

    Parameters
    ----------
    controller : Controller
        Where the search starts.
    goal : Goal
        Whose scenario, scores and draws count.

    Raises
    ------
    InputError
        The scenario begins away from rest, where it has one start for all plants.

    Examples
    --------
    On the second plant the pumps are stronger and the tanks wider:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.studies.tuning.draws import draws_at
    >>> from clepsydra.studies.tuning.objective import minimax
    >>> plant = cl.load("quadruple-tank")
    >>> goal = Goal(plant.linear, default_scenario(plant.linear), minimax("iae[level_1]"),
    ...             draws=draws_at(plant.linear, 2))
    >>> drawn = DrawnCandidates(cl.design.simc(plant), goal)
    >>> drawn.run({"level_1.proportional_gain": np.array([3.0, 6.0])}).scores["iae[level_1]"].shape
    (2, 2)
    """

    def __init__(self, controller: Controller, goal: Goal) -> None:
        draws = goal.draws
        assert draws is not None
        if goal.scenario.begin is not None:
            raise InputError(
                "tuning, draws", draws.count, "a scenario that begins at rest, as each plant does",
                "leave draws out, or begin at rest",
            )  # fmt: skip
        self._plants, self._names = draws.every, goal.objective.names
        self._own = controller.values
        loop = Loop(controller, goal.model)
        names = dict.fromkeys((*self._names, *judged_names(loop.process)))
        self._batch = LoopBatch(loop, goal.scenario, tuple(names))
        state, inputs = loop.point.state, loop.point.inputs
        itself = self._batch.run(ManyPlants(loop.point, state[:, None], inputs[:, None]))
        happened = happened_in(self._batch, itself)
        # What the plant itself meets at the start is no fault of a candidate; that a run means
        # nothing is never usual.
        self._counted = [
            what for what in FAILURES if what is Happening.UNSOLVED or not happened[what][0]
        ]

    def run(self, values: Mapping[str, np.ndarray]) -> DrawnRuns:
        """Return what comes of candidates with these values [candidates].

        Parameters
        ----------
        values : mapping
            Parameters of the law; the others are the controller's.
        """
        (count,) = np.broadcast_shapes((1,), *map(np.shape, values.values()))
        columns = {name: np.broadcast_to(column, count) for name, column in values.items()}
        step = max(1, self._lanes // self._plants.count)
        parts = [
            self._part({name: column[low : low + step] for name, column in columns.items()})
            for low in range(0, count, step)
        ]
        return DrawnRuns(
            {name: np.vstack([part.scores[name] for part in parts]) for name in self._names},
            {what: np.vstack([part.failures[what] for part in parts]) for what in FAILURES},
        )

    @property
    def _lanes(self) -> int:
        rows = 1 + _DISTURBANCE * len(self._plants.disturbances)
        samples = self._batch.scenario.samples * max(self._batch.substeps, rows)
        return int(np.clip(_SAMPLES // samples, _FEWEST, _MOST))

    def _part(self, values: Mapping[str, np.ndarray]) -> DrawnRuns:
        plants = self._plants
        (count,) = np.broadcast_shapes((1,), *map(np.shape, values.values()))
        run = self._batch.run(
            ManyPlants(
                plants.point,
                np.tile(plants.state, count),
                np.tile(plants.inputs, count),
                {name: np.tile(column, count) for name, column in plants.values.items()},
                {name: np.repeat(column, plants.count) for name, column in values.items()},
            )
        )
        scores = {name: self._batch.scores_of(run, name)[0] for name in self._names}
        shape = count, plants.count
        return DrawnRuns(
            {name: column.reshape(shape) for name, column in scores.items()},
            {what: truths.reshape(shape) for what, truths in self._failures(run).items()},
        )

    def _failures(self, run: BatchRun) -> dict[Happening, Truths]:
        happened, broken = happened_in(self._batch, run), run.broken()
        return {
            what: happened[what] if what in self._counted else _at_least(what, broken)
            for what in FAILURES
        }


def _at_least(what: Happening, broken: Truths) -> Truths:
    """Return what counts of something that happens to the plant itself as well."""
    return broken if what is Happening.UNSTABLE else np.zeros_like(broken)
