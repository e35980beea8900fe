"""What controllers are compared by: the scores that count, as multiples of the best."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.scores.band import TIME_OUTSIDE
from clepsydra.scores.score import SCORES, Ranks
from clepsydra.scores.score_key import score_key
from clepsydra.studies.result import Standing, TriedController

if TYPE_CHECKING:
    from collections.abc import Mapping

    from clepsydra.process.process import Process

#: What is smaller no sensor shows, and is no reason to call a controller many times worse than
#: another: a mean error or a move, as a share of the signal's range; see `Score.negligible`.
_SMALLEST_SHARE = 1e-5


class Yardstick(NamedTuple):
    """What a score is a multiple of: the best of a study, and what of it counts as nothing [SI].

    Examples
    --------
    >>> Yardstick(2.0, 0.5, less_is_better=True).multiple(3.0)
    1.5
    """

    best: float | None
    smallest: float
    less_is_better: bool

    def multiple(self, value: float) -> float:
        """Return how many times worse than the best a value is; 1 where there is no best."""
        if not math.isfinite(value):
            return math.inf
        if self.best is None:
            return 1.0
        better, worse = (self.best, value) if self.less_is_better else (value, self.best)
        if max(better, self.smallest) == 0.0:
            return 1.0 if worse == 0.0 else math.inf
        return max(worse, self.smallest) / max(better, self.smallest)


class Judge:
    """The scores that count for a process, as multiples of the best.

    Parameters
    ----------
    example : TriedController
        It says which scores there are.
    best_of : sequence of TriedController
        Of the first group of the ranking.
    standing : Standing
        Of that group.
    scores : sequence of str
        As of `rank`.

    Attributes
    ----------
    judged : dict
        Title of each criterion to the scores that it is the mean of.
    worn : list of str
        The scores that the wear is the mean of.
    """

    def __init__(
        self,
        example: TriedController,
        best_of: Sequence[TriedController],
        standing: Standing,
        scores: Sequence[str],
    ) -> None:
        process = example.run.process
        self.process = process
        self.duration = float(example.run.time[-1] - example.run.time[0])
        self.best_of = best_of
        # A controller without setpoints has fewer scores than others.
        every = {key: value for trial in best_of for key, value in trial.scores.items()}
        named = {score: _keys(score, every) for score in scores}
        usual = usual_criteria(process, example.scores)
        if standing is Standing.OUTSIDE:  # all others leave a band too
            usual = {TIME_OUTSIDE.title: [f"{TIME_OUTSIDE.key}[{name}]" for name in process.bands]}
        self.judged = {score_key(score).title: keys for score, keys in named.items()} or usual
        moves = _ranking(Ranks.MOVEMENT)
        self.worn = [f"{key}[{u.name}]" for key in moves for u in process.inputs]

    def criteria(self, trial: TriedController) -> dict[str, float]:
        """Return the mean multiple of each criterion."""
        return {title: self._mean(trial, keys) for title, keys in self.judged.items()}

    def wear(self, trial: TriedController) -> float:
        """Return the mean multiple of the total variation."""
        return self._mean(trial, self.worn)

    def yardstick(self, key: str) -> Yardstick:
        """Return what a score is a multiple of."""
        less_is_better = score_key(key).declared.smaller_is_better
        known = [trial.scores.get(key, math.inf) for trial in self.best_of]
        finite = [found for found in known if math.isfinite(found)]
        best = (min if less_is_better else max)(finite, default=None)
        return Yardstick(best, negligible(self.process, key, self.duration), less_is_better)

    def _mean(self, trial: TriedController, keys: Sequence[str]) -> float:
        values = [trial.scores.get(key, math.inf) for key in keys]
        multiples = [self.yardstick(key).multiple(v) for key, v in zip(keys, values, strict=True)]
        return float(np.mean(multiples))


def negligible(process: Process, key: str, duration: float) -> float:
    """Return what of a score counts as nothing [its unit].

    Parameters
    ----------
    key : str
        "iae[level_1]".
    duration : float
        Of the run [s].

    Examples
    --------
    A mean error of 0.001 % of 10 V over an hour:

    >>> from clepsydra.process.reader import load_process
    >>> round(negligible(load_process("quadruple-tank"), "iae[level_1]", 3600.0), 6)
    0.36
    """
    score, name = score_key(key)
    declared = SCORES[score]
    if declared.unit:
        return declared.negligible or 0.0
    if not declared.powers[0]:
        return process.sampling_period
    span = process.signal(name).span
    if not math.isfinite(span):
        return 0.0
    if declared.negligible is not None:
        return declared.negligible * span
    return _SMALLEST_SHARE * span * (duration if declared.powers[1] else 1.0)


def usual_criteria(process: Process, known: Collection[str]) -> dict[str, list[str]]:
    """Return what controllers of a process are judged by where nobody says by what.

    Parameters
    ----------
    known : collection of str
        The scores of a run, "iae_load[level]".

    Returns
    -------
    dict
        Title of each criterion to the scores that it is the mean of.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> usual_criteria(load_process("wet-well"), ["iae[level]", "iae_load[level]"])
    {'load error': ['iae_load[level]']}
    """
    return {
        title: keys
        for title, score, signals in _judged_by(process)
        if (keys := [key for name in signals if (key := f"{score}[{name}]") in known])
    } or {"error": [f"iae[{name}]" for name in process.controlled]}


def of_averaging(process: Process) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Return the scores that levels which average are judged by, each with its levels.

    Where a band says how much room there is, that and the fastest change of the outflow are all.
    """
    free = tuple(name for name in process.averaging if name not in process.bands)
    of = {Ranks.AVERAGING: process.averaging, Ranks.AVERAGING_FREELY: free}
    return tuple((key, levels) for what, levels in of.items() for key in _ranking(what))


def _ranking(what: Ranks) -> list[str]:
    """Return the scores that controllers are ranked for something by."""
    return [score.key for score in SCORES.values() if score.ranks is what]


def _judged_by(process: Process) -> tuple[tuple[str, str, tuple[str, ...]], ...]:
    """Return title, score and signals of what controllers of a process are judged by."""
    held = tuple(name for name in process.controlled if name not in process.averaging)
    judged = [*((key, held) for key in _ranking(Ranks.HELD)), *of_averaging(process)]
    return tuple((SCORES[key].words, key, signals) for key, signals in judged)


def _keys(score: str, scores: Mapping[str, float]) -> list[str]:
    """Return the scores of a run that a name stands for."""
    found = [key for key in scores if score in (key, score_key(key).score)]
    if not found:
        known = ", ".join(dict.fromkeys(score_key(key).score for key in scores))
        raise InputError(
            "ranking, scores", score, f"a score of this scenario and its signals: {known}",
            "choose one of them, or give the scenario the step that it judges",
        )  # fmt: skip
    return found
