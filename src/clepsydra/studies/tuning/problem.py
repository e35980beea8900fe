"""A tuning problem: which candidate is how good, evaluated once and remembered."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.lane_status import LaneStatus
from clepsydra.loop.running_scores import running_scores
from clepsydra.scores.score_key import score_key
from clepsydra.studies.tuning.batch import BatchEvaluation
from clepsydra.studies.tuning.candidate_loops import CandidateLoops
from clepsydra.studies.tuning.memory import Memory
from clepsydra.studies.tuning.objective import ON_LIMIT, Goal
from clepsydra.studies.tuning.search_space import SearchSpace


class Evaluation(NamedTuple):
    """What is known of some candidates.

    Parameters
    ----------
    objective : ndarray [n]
        Infinite where the run broke off.
    parts : ndarray [n, scores]
        What the objective is the largest or the sum of.
    margins : ndarray [n, limits]
        Room to each limit but that of max|S|, as a share of it; negative where it is passed.
    """

    objective: np.ndarray
    parts: np.ndarray
    margins: np.ndarray

    @property
    def violation(self) -> np.ndarray:
        """How far a candidate is beyond its worst limit [n], 0 where it keeps all."""
        return np.asarray(np.max(-self.margins, axis=1, initial=0.0))


class Judgement(NamedTuple):
    """What is known of a controller as it runs, its values rounded.

    Parameters
    ----------
    scores : dict
        "score[signal]" to value.
    margins : ndarray [limits]
        As in `Evaluation`.
    sensitivity : float
        max|S| of all loops together; infinite if unstable.
    damping : float
        Smallest damping ratio of what oscillates in the loops.
    """

    scores: dict[str, float]
    objective: float
    margins: np.ndarray
    sensitivity: float
    damping: float


class BestSoFar(NamedTuple):
    """The best candidate that keeps every limit, at a point [p]."""

    point: np.ndarray
    objective: float
    sensitivity: float


class TuningProblem:
    """Candidates are points of the unit cube; each is simulated once, however often asked for.

    Raises
    ------
    InputError
        A score or limit names an unknown signal, an overshoot is limited where no setpoint
        steps, or the scores of the start are no measure.
    """

    def __init__(self, space: SearchSpace, goal: Goal) -> None:
        self.space, self.objective, self.limits = space, goal.objective, goal.limits
        model = goal.model
        self.limited = _limited(goal, space.controller)
        self.names = tuple(dict.fromkeys([*goal.objective.names, *self.limited]))
        self.batch = BatchEvaluation(space.controller, model, goal.scenario, self.names)
        self._room = _Room(self.limited, self.names)
        self.memory = Memory(len(space.start), len(self.names) + 1, self._digest(goal))
        self.loops = CandidateLoops(space, model, self.limits, self.memory)
        self.best: BestSoFar | None = None
        self.history: list[tuple[int, float]] = []
        self.on_progress: Callable[[], None] = lambda: None
        self._asked: set[bytes] = set()
        self.proper: dict[bytes, np.ndarray] = {}
        #: Up to which max|S| candidates have an objective that can be compared.
        self.front_limit = math.inf

    def begin(self) -> None:
        """Evaluate the start, from which scores are scaled.

        Raises
        ------
        InputError
        """
        own = self.space.controller.values
        rows = self._run_with(own)
        self.start_scores = self._named(rows)
        # What happens at the start in any case, an empty tank say, is no fault of a candidate;
        # that a run means nothing is never usual.
        meaningless = LaneStatus.NOT_A_NUMBER | LaneStatus.STEP_TOO_LONG
        self._usual = int(rows[0, -1]) & ~int(meaningless)
        self.objective.check_start(self.start_scores)
        self.start = self._judged(own, rows)
        start = self.space.start[None, :]
        self.consider(start, self.evaluate(start))

    @property
    def words(self) -> str:
        """What is minimised, as a phrase."""
        return self.objective.words

    @property
    def evaluations(self) -> int:
        """Number of different candidates asked for."""
        return len(self._asked)

    def judge(self, values: Mapping[str, float]) -> Judgement:
        """Return what simulation says of the controller with all its values.

        The search moves between numbers that are not rounded; its start and what it found are
        controllers, whose numbers are.
        """
        return self._judged(values, self._run_with(values))

    def _judged(self, values: Mapping[str, float], rows: np.ndarray) -> Judgement:
        found = self._evaluation(rows)
        loop = self.loops.sampled.at(values)
        return Judgement(
            self._named(rows),
            float(found.objective[0]),
            found.margins[0],
            loop.maximum_sensitivity,
            loop.damping,
        )

    def _named(self, rows: np.ndarray) -> dict[str, float]:
        return dict(zip(self.names, rows[0, :-1].tolist(), strict=True))

    def evaluate(self, points: np.ndarray, proper: int | None = None) -> Evaluation:
        """Return what simulation says of candidates [n, p].

        Parameters
        ----------
        proper : int, optional
            How many, from the first, are candidates in their own right; the others are
            probes for a derivative. All if omitted.
        """
        rows = self._rows(points)
        for point in points[:proper]:
            self.proper.setdefault(point.tobytes(), point.copy())
        return self._evaluation(rows)

    def _evaluation(self, rows: np.ndarray) -> Evaluation:
        scores = {name: rows[:, place] for place, name in enumerate(self.names)}
        parts = self.objective.parts(scores, self.start_scores)
        objective = self.objective.value(parts)
        status = rows[:, -1].astype(int) & ~self._usual
        objective[status != 0] = np.inf
        objective[~np.isfinite(objective)] = np.inf
        return Evaluation(objective, parts, self._room.of(rows))

    def _rows(self, points: np.ndarray) -> np.ndarray:
        """Return scores and status of every candidate [n, scores + 1], simulating new ones."""
        keys = [point.tobytes() for point in points]
        missing = {
            key: point
            for key, point in zip(keys, points, strict=True)
            if key not in self.memory.rows
        }
        if missing:
            rows = self._simulated(np.array(list(missing.values())))
            for key, row in zip(missing, rows.tolist(), strict=True):
                self.memory.rows[key] = row
        self._asked.update(keys)
        self.on_progress()
        return np.array([self.memory.rows[key] for key in keys])

    def _simulated(self, points: np.ndarray) -> np.ndarray:
        """Return scores and status of candidates [n, scores + 1]; infinite without a law."""
        values = self.space.values_at(points)
        usable = np.all([np.isfinite(column) for column in values.values()], axis=0)
        own = self.space.controller.values
        rows = self._run_with(
            {name: np.where(usable, column, own[name]) for name, column in values.items()}
        )
        rows[~usable, :-1] = np.inf
        return rows

    def _run_with(self, values: Mapping[str, ArrayLike]) -> np.ndarray:
        """Return scores and status of candidates with these values [n, scores + 1]."""
        found = self.batch.run({name: np.atleast_1d(value) for name, value in values.items()})
        return np.stack([*(found.scores[name] for name in self.names), found.status], axis=1)

    def consider(self, points: np.ndarray, found: Evaluation) -> None:
        """Keep the best of the first candidates if it beats the best and keeps all limits.

        Parameters
        ----------
        points : ndarray [k, p]
            The first of those that were evaluated.
        found : Evaluation
            Of all.
        """
        objective = found.objective[: len(points)]
        best = self.best.objective if self.best else np.inf
        better = (objective < best) & (found.violation[: len(points)] <= ON_LIMIT)
        places = [place for place in np.argsort(objective, kind="stable") if better[place]]
        rooms = self.loops.rooms(points[places], self.limits.maximum_sensitivity)
        kept = np.flatnonzero(np.all(rooms >= -ON_LIMIT, axis=1))
        if kept.size:
            place = places[kept[0]]
            point, value = points[place].copy(), float(objective[place])
            self.best = BestSoFar(point, value, float(self.loops.sensitivities(point[None])[0]))
            self.history.append((self.evaluations, value))

    def _digest(self, goal: Goal) -> str:
        """Return what tells this problem from any other."""
        controller, scenario, point = self.space.controller, goal.scenario, goal.model.point
        said = {
            "program": repr(self.batch.program),
            "values": controller.values,
            "state": controller.initial_state,
            "parameters": [asdict(parameter) for parameter in self.space.parameters],
            "numbers": dict(self.space.numbers),
            "objective": asdict(self.objective),
            "limits": asdict(self.limits),
            "segments": [[asdict(part) for part in scenario.segments]],
        }
        if goal.draws is not None:
            said["draws"] = goal.draws.digest
        if scenario.begin is not None:
            said["begin"] = scenario.begin.as_dict()
        digest = hashlib.sha256(json.dumps(said, sort_keys=True).encode())
        state = [] if point is None else [point.state, point.inputs, point.disturbances]
        model, moves = goal.model, (scenario.setpoints, scenario.disturbances, scenario.noise)
        for array in (model.A, model.B, model.C, *state, *moves):
            digest.update(np.ascontiguousarray(array, dtype=float).tobytes())
        return digest.hexdigest()


def _limited(goal: Goal, controller: Controller) -> dict[str, float]:
    """Return the scores that have a limit, and that [their unit]."""
    limits, segments = goal.limits, goal.scenario.segments
    process = operating_point_of(goal.model).process
    kinds = {part.kind for part in segments}
    stepped = sorted({part.signal for part in segments if part.kind == "setpoint"})
    if math.isfinite(limits.overshoot) and not stepped:
        raise InputError(
            "tuning, limits, overshoot", limits.overshoot,
            "a scenario with a setpoint step", "drop the limit",
        )  # fmt: skip
    largest = min(limits.overshoot, limits.overshoot_if_stepped)
    found = {f"overshoot[{y}]": largest for y in stepped if math.isfinite(largest)}
    if math.isfinite(limits.noise_movement) and "noise" in kinds:
        moved = [u for u in process.inputs if u.name in controller.manipulated and u.has_range]
        found |= {f"noise_movement[{u.name}]": limits.noise_movement * u.span for u in moved}
    found |= {f"total_variation[{u}]": value for u, value in limits.total_variation.items()}
    for name, (low, high) in limits.levels.items():
        found |= {f"lowest[{name}]": low, f"highest[{name}]": high}
    if "load" in kinds:
        for name, (low, high) in process.bands.items():
            found |= {f"lowest_under_load[{name}]": low, f"highest_under_load[{name}]": high}
    return found


class _Room:
    """How much room candidates have to limits of scores, each by name."""

    def __init__(self, limited: Mapping[str, float], names: Sequence[str]) -> None:
        declared = running_scores()
        smaller = [declared[score_key(name).score].smaller_is_better for name in limited]
        self._columns = [names.index(name) for name in limited]
        self._limits = np.array([*limited.values()])
        self._signs = np.where(smaller, 1.0, -1.0)
        self._sizes = np.where(self._limits == 0.0, 1.0, np.abs(self._limits))

    def of(self, rows: np.ndarray) -> np.ndarray:
        """Return the room to each limit, as a share of it [n, limits], from scores [n, scores]."""
        return np.asarray(self._signs * (self._limits - rows[:, self._columns]) / self._sizes)
