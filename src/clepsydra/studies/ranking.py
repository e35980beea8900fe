"""The order of the controllers of a study by a printed rule."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.scores.band import TIME_OUTSIDE
from clepsydra.scores.effort import IDLE, NOISE_MOVEMENT
from clepsydra.scores.score import SCORES, Ranks, in_sentence
from clepsydra.scores.score_key import score_key
from clepsydra.studies.departure import departures
from clepsydra.studies.ranking_words import (
    STANDINGS,
    TIE,
    percent,
    reason,
    with_article,
)
from clepsydra.studies.recommendation import as_good_as_first, recommend, rival_of
from clepsydra.studies.result import ACCEPTED, Candidate, Standing, TriedController
from clepsydra.studies.warnings.harm import harms
from clepsydra.studies.warnings.margins import LARGEST_PEAK
from clepsydra.studies.warnings.strokes import STROKES, driven_to_and_fro

if TYPE_CHECKING:
    from clepsydra.base.remark import Remark
    from clepsydra.process.process import Process

_GROUPS = (
    "safe, robust and quiet controllers first (levels stay in their tanks, nothing runs dry, "
    "no pump trips, no load drives a level out of its band, max|S| at most 2.0, also of inner "
    "loops, measurement noise throws no manipulated variable about by more than 5 % of its range, "
    f"and no step sends one from end to end more than {STROKES} times), "
    "then nervous ones, which are not "
    "quiet, then stable ones, then those that leave a band, then the rest. Among these "
)
_USUAL = (
    "the smaller mean of setpoint error and load error: the integral absolute error over all "
    "setpoint steps and over all load steps, without the stretch of noise, each averaged over the "
    "controlled variables as multiples of the best among the first of these groups; one that is "
    "below 0.001 % of the range in the mean over the run counts as that much. Where a level "
    "is there to average a flow, outflow change and outflow variance, its largest rate of change "
    "and its variance ratio over the load steps, stand in place of its errors; where the level has "
    "a band, which says how much room there is, the outflow change alone, or the time outside "
    "where no controller keeps the band. A run without such steps is judged by the error over the "
    "whole of it."
)
_TIES = (
    " Within 2 % of each other the smaller total variation of the manipulated variables, averaged "
    f"as multiples in the same way; one below {100 * IDLE:.0f} % of the variable's range counts as "
    "that much."
)
RULE = _GROUPS + _USUAL + _TIES

#: Largest noise movement of a quiet controller, share of the input's range.
QUIET = 0.05
#: What is smaller no sensor shows, and is no reason to call a controller many times worse than
#: another: a mean error or a move, as a share of the signal's range; see `Score.negligible`.
_SMALLEST_SHARE = 1e-5


class Trial(TriedController):
    """One controller with its run and scores, before it has a rank."""

    @property
    def standing(self) -> Standing:
        """How far it can be trusted."""
        if harms(self.run):
            return Standing.UNSAFE
        if departures(self.run.process, self.scores):
            return Standing.UNSAFE if math.isinf(self.maximum_sensitivity) else Standing.OUTSIDE
        if not self.controller.setpoints:  # it switches at levels, and has no linear loop
            return Standing.ROBUST
        if not math.isfinite(self.maximum_sensitivity):
            return Standing.UNSAFE
        inner = self.inner_peak
        peak = max(self.maximum_sensitivity, inner[1] if inner else 0.0)
        if peak > LARGEST_PEAK:
            return Standing.STABLE
        quiet = self.noise_movement <= QUIET and not driven_to_and_fro(self.run)
        return Standing.ROBUST if quiet else Standing.NERVOUS

    @property
    def noise_movement(self) -> float:
        """The largest share of an input's range by which noise throws it about."""
        return max(
            (
                self.scores.get(f"{NOISE_MOVEMENT.key}[{u.name}]", 0.0) / u.span
                for u in self.run.process.inputs
            ),
            default=0.0,
        )


def rule_of(scores: Sequence[str]) -> str:
    """Return the rule in words, by the scores that a study asks for or by the usual ones.

    Examples
    --------
    >>> rule_of(["iae", "overshoot[level]"]).partition("Among these ")[2][:44]
    'the smaller mean of IAE and overshoot of lev'
    """
    if not scores:
        return RULE
    asked = (
        f"the smaller mean of {_listed(scores)}, each averaged "
        "over its signals as multiples of the best among the first of these groups."
    )
    return _GROUPS + asked + _TIES


def rank(trials: Sequence[Trial], scores: Sequence[str] = ()) -> tuple[Candidate, ...]:
    """Return the candidates, best first, each with its reason.

    Parameters
    ----------
    trials : sequence of Trial
        All of one process and one scenario.
    scores : sequence of str
        What to judge by in the place of the rule's errors: names of scores, of all their signals
        or as "iae[level]" of one.

    Returns
    -------
    tuple of Candidate
        With the numbers that decided: `criteria`, their mean `mean_error`, and `wear`.

    Raises
    ------
    InputError
        A score that is asked for is none of these runs.
    """
    if not trials:
        return ()
    standings = [trial.standing for trial in trials]
    first = [t for t, s in zip(trials, standings, strict=True) if s is min(standings)]
    judge = _Judge(trials[0], first, scores)
    candidates = []
    for trial, standing in zip(trials, standings, strict=True):
        criteria = judge.criteria(trial)
        candidates.append(
            Candidate(
                **vars(trial),
                standing=standing,
                mean_error=float(np.mean(list(criteria.values()))),
                criteria=criteria,
                wear=judge.wear(trial),
            )
        )
    groups = _groups(candidates)
    ordered = [(candidate, number) for number, group in enumerate(groups) for candidate in group]
    least = ordered[0][0].mean_error
    ranking = []
    for place, (candidate, group) in enumerate(ordered):
        rival, other = ordered[place - 1] if place else (*ordered, (None, None))[1]
        words = reason(candidate, rival, ahead=not place, tied=other == group)
        mean = candidate.mean_error
        relative = 1.0 if mean == least else mean / least if math.isfinite(least) else math.nan
        ranking.append(replace(candidate, rank=place + 1, relative_error=relative, reason=words))
    return tuple(ranking)


def verdict(
    process: Process,
    ranking: Sequence[Candidate],
    accept: float = ACCEPTED,
    out_of_reach: Sequence[Remark] = (),
) -> str:
    """Return the answer of a study in one sentence: what to use, and what speaks for it.

    Parameters
    ----------
    ranking : sequence of Candidate
        Best first.
    accept : float
        As of `recommend`.
    out_of_reach : sequence of Remark
        What the scenario asks of final elements that they cannot give: where no controller can be
        recommended, that is told first.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> verdict(load_process("three-tanks"), [])
    'No controller of this study applies to Three coupled tanks; the reasons are listed.'
    """
    if not ranking:
        return f"No controller of this study applies to {process.title}; the reasons are listed."
    best, advice = ranking[0], recommend(ranking, accept)
    if advice is None:
        first = "".join(f"{each.brief} " for each in out_of_reach)
        return (
            f"{first}No controller of this study can be recommended for {process.title}; "
            f"the least bad is {best.controller.title}: {best.reason[0].lower()}{best.reason[1:]}"
        )
    use = f"Use {advice.simplest.controller.title} on {process.title}"
    if advice.simplest is best:
        return f"{use}: the best{_lead(ranking)}."
    return f"{use}: {advice.why}."


def _lead(ranking: Sequence[Candidate]) -> str:
    """Return what decided between the winner and its rival, by the rule of the ranking."""
    best, rival, alike = ranking[0], rival_of(ranking), as_good_as_first(ranking)
    if rival is None:
        return " that was tried"
    words = _beside(best, rival)
    if not alike or rival in alike:
        return words
    also = f"{alike[0].controller.title} is" if len(alike) == 1 else f"{len(alike)} of its kind are"
    return f"{words}; {also} as good"


def _beside(best: Candidate, rival: Candidate) -> str:
    name = rival.controller.title
    if rival.standing is Standing.OUTSIDE:
        return f", which keeps the band where {name} does not"
    if best.standing is not rival.standing:
        return f", {STANDINGS[best.standing]} where {name} is not"
    if rival.mean_error > TIE * best.mean_error:
        saved = 100 * (1 - best.mean_error / rival.mean_error)
        judged = " and ".join(in_sentence(title) for title in best.criteria)
        if len(best.criteria) > 1:
            return f", with {percent(saved)} less {judged} on average than {name}"
        return f", with {with_article(judged)} {percent(saved)} below that of {name}"
    return f", as good as {name} with less movement of the inputs"


def _groups(candidates: Sequence[Candidate]) -> list[list[Candidate]]:
    """Return the candidates best first, in groups within which the wear decides."""
    groups = []
    waiting = sorted(candidates, key=lambda candidate: (candidate.standing, candidate.mean_error))
    while waiting:
        first = waiting[0]
        tied = [
            candidate
            for candidate in waiting
            if candidate.standing is first.standing
            and candidate.mean_error <= TIE * first.mean_error
        ]
        groups.append(sorted(tied, key=lambda candidate: candidate.wear))
        waiting = waiting[len(tied) :]
    return groups


class _Judge:
    """The scores that count for a process, as multiples of the best."""

    def __init__(self, example: Trial, best_of: Sequence[Trial], scores: Sequence[str]) -> None:
        process = example.run.process
        self.process = process
        self.duration = float(example.run.time[-1] - example.run.time[0])
        self.best_of = best_of
        # A controller without setpoints has fewer scores than others.
        every = {key: value for trial in best_of for key, value in trial.scores.items()}
        named = {score: _keys(score, every) for score in scores}
        usual = usual_criteria(process, example.scores)
        if best_of[0].standing is Standing.OUTSIDE:  # all others leave a band too
            usual = {TIME_OUTSIDE.title: [f"{TIME_OUTSIDE.key}[{name}]" for name in process.bands]}
        self.judged = {score_key(score).title: keys for score, keys in named.items()} or usual

    def criteria(self, trial: Trial) -> dict[str, float]:
        """Return the mean multiple of each criterion."""
        return {title: self._mean(trial, keys) for title, keys in self.judged.items()}

    def wear(self, trial: Trial) -> float:
        """Return the mean multiple of the total variation."""
        moves = _ranking(Ranks.MOVEMENT)
        return self._mean(trial, [f"{key}[{u.name}]" for key in moves for u in self.process.inputs])

    def _mean(self, trial: Trial, keys: Sequence[str]) -> float:
        return float(
            np.mean([self._multiple(key, trial.scores.get(key, math.inf)) for key in keys])
        )

    def _multiple(self, key: str, value: float) -> float:
        if not math.isfinite(value):
            return math.inf
        smallest = self._smallest(key)
        known = [trial.scores.get(key, math.inf) for trial in self.best_of]
        finite = [found for found in known if math.isfinite(found)]
        if not finite:
            return 1.0
        less_is_better = score_key(key).declared.smaller_is_better
        better, worse = (min(finite), value) if less_is_better else (value, max(finite))
        if max(better, smallest) == 0.0:
            return 1.0 if worse == 0.0 else math.inf
        return max(worse, smallest) / max(better, smallest)

    def _smallest(self, key: str) -> float:
        """Return what of a score counts as nothing."""
        score, name = score_key(key)
        declared = SCORES[score]
        if declared.unit:
            return declared.negligible or 0.0
        if not declared.powers[0]:
            return self.process.sampling_period
        span = self.process.signal(name).span
        if not math.isfinite(span):
            return 0.0
        if declared.negligible is not None:
            return declared.negligible * span
        return _SMALLEST_SHARE * span * (self.duration if declared.powers[1] else 1.0)


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


def _listed(scores: Sequence[str]) -> str:
    return " and ".join(in_sentence(score_key(score).title) for score in scores)
