"""The order of the controllers of a study by a printed rule."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.words import with_article
from clepsydra.scores.effort import IDLE, NOISE_MOVEMENT
from clepsydra.scores.score import in_sentence
from clepsydra.scores.score_key import score_key
from clepsydra.studies.departure import departures
from clepsydra.studies.judge import Judge
from clepsydra.studies.ranking_words import (
    STANDINGS,
    TIE,
    percent,
    reason,
    trust_sentence,
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
    standings = [trial.standing for trial in trials]
    first = [t for t, s in zip(trials, standings, strict=True) if s is min(standings)]
    return in_order(judged(trials, first, scores))


def judged(
    trials: Sequence[Trial], best_of: Sequence[Trial], scores: Sequence[str] = ()
) -> list[Candidate]:
    """Return trials with the numbers that decide between them, in the order given.

    Parameters
    ----------
    best_of : sequence of Trial
        Those whose best an error is a multiple of, all of one standing or worse ones.
    scores : sequence of str
        As for `rank`.
    """
    if not trials:
        return []
    judge = Judge(trials[0], best_of, min(trial.standing for trial in best_of), scores)
    candidates = []
    for trial in trials:
        criteria = judge.criteria(trial)
        candidates.append(
            Candidate(
                **vars(trial),
                standing=trial.standing,
                mean_error=float(np.mean(list(criteria.values()))),
                criteria=criteria,
                wear=judge.wear(trial),
            )
        )
    return candidates


def in_order(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return candidates, best first, each with its rank and what put it there."""
    groups = _groups(candidates)
    ordered = [(candidate, number) for number, group in enumerate(groups) for candidate in group]
    ranking = []
    for place, (candidate, group) in enumerate(ordered):
        rival, other = ordered[place - 1] if place else (*ordered, (None, None))[1]
        words = reason(candidate, rival, ahead=not place, tied=other == group)
        mean, least = candidate.mean_error, ordered[0][0].mean_error
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
        What the scenario asks of final elements that they cannot give, which is told first.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> verdict(load_process("three-tanks"), [])
    'No controller of this study applies to Three coupled tanks; the reasons are listed.'
    """
    if not ranking:
        return f"No controller of this study applies to {process.title}; the reasons are listed."
    best, advice = ranking[0], recommend(ranking, accept)
    first = "".join(f"{each.brief} " for each in out_of_reach)
    if advice is None:
        whom = f"for every case of {process.title}" if best.cases else f"for {process.title}"
        why = trust_sentence(best) if best.cases else best.reason
        return (
            f"{first}No controller of this study can be recommended {whom}; "
            f"the least bad is {best.controller.title}: {why[0].lower()}{why[1:]}"
        )
    use = f"{first}Use {advice.simplest.controller.title} on {process.title}"
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
        criteria = " and ".join(in_sentence(title) for title in best.criteria)
        at_worst = " in the worst case" if best.cases else ""
        if len(best.criteria) > 1:
            return f", with {percent(saved)} less {criteria} on average{at_worst} than {name}"
        return f", with {with_article(criteria)}{at_worst} {percent(saved)} below that of {name}"
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


def _listed(scores: Sequence[str]) -> str:
    return " and ".join(in_sentence(score_key(score).title) for score in scores)
