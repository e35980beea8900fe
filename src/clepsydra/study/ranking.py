"""The order of the controllers of a study by a printed rule, and the reason in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.loop.run import Run
from clepsydra.process.process import Process
from clepsydra.study.result import Candidate, Standing
from clepsydra.study.warnings import leaves_its_tanks

RULE = (
    "safe and robust controllers first (levels stay in their tanks, max|S| at most 2.0), then "
    "stable ones, then the rest; among these the smaller integral absolute error, averaged over "
    "the controlled variables as multiples of the best; within 2 % of each other the smaller "
    "total variation of the manipulated variables."
)

_STANDINGS = {Standing.ROBUST: "robust", Standing.STABLE: "stable"}
_ROBUST = 2.0
#: The designs stop exactly at the limit; this much above it is rounding.
_ROUNDING = 1e-6
_TIE = 1.02


@dataclass(frozen=True, eq=False)
class Trial:
    """One controller with its run and scores, before it has a rank."""

    controller: Controller
    run: Run
    scores: dict[str, float]
    maximum_sensitivity: float
    warnings: tuple[str, ...]

    @property
    def standing(self) -> Standing:
        """How far it can be trusted."""
        if not math.isfinite(self.maximum_sensitivity) or leaves_its_tanks(self.run):
            return Standing.UNSAFE
        if self.maximum_sensitivity <= _ROBUST * (1 + _ROUNDING):
            return Standing.ROBUST
        return Standing.STABLE

    def mean_score(self, score: str, best: dict[str, float]) -> float:
        """Return the mean over signals of a score as a multiple of the best one."""
        ratios = [
            _ratio(value, best[key])
            for key, value in self.scores.items()
            if key.startswith(f"{score}[")
        ]
        return float(np.mean(ratios)) if ratios else math.inf


def rank(trials: Sequence[Trial]) -> tuple[Candidate, ...]:
    """Return the candidates, best first, each with its reason.

    Parameters
    ----------
    trials : sequence of Trial
        All of one process and one scenario.
    """
    best = {
        key: min(trial.scores[key] for trial in trials)
        for key in (trials[0].scores if trials else {})
    }
    errors = {id(trial): trial.mean_score("iae", best) for trial in trials}
    wear = {id(trial): trial.mean_score("total_variation", best) for trial in trials}
    ordered: list[Trial] = []
    waiting = sorted(trials, key=lambda trial: (trial.standing, errors[id(trial)]))
    while waiting:
        first = waiting[0]
        tied = [
            trial
            for trial in waiting
            if trial.standing == first.standing and errors[id(trial)] <= _TIE * errors[id(first)]
        ]
        ordered += sorted(tied, key=lambda trial: wear[id(trial)])
        waiting = [trial for trial in waiting if trial not in tied]
    return tuple(
        Candidate(
            controller=trial.controller,
            run=trial.run,
            scores=trial.scores,
            maximum_sensitivity=trial.maximum_sensitivity,
            standing=trial.standing,
            mean_error=errors[id(trial)],
            rank=place,
            reason=_reason(trial, errors[id(trial)], wear[id(trial)]),
            warnings=trial.warnings,
        )
        for place, trial in enumerate(ordered, 1)
    )


def verdict(process: Process, ranking: Sequence[Candidate]) -> str:
    """Return the answer of a study in one sentence."""
    if not ranking:
        return f"No controller of this study applies to {process.title}; the reasons are listed."
    best = ranking[0]
    if best.standing is Standing.UNSAFE:
        return (
            f"No controller of this study can be recommended for {process.title}; the least bad "
            f"is {best.controller.name}: {best.reason[0].lower()}{best.reason[1:]}"
        )
    watch = (
        f"watch: {best.warnings[0].rstrip('.')}"
        if best.warnings
        else "no level leaves its tank and no input saturates for long"
    )
    return (
        f"{best.controller.name} controls {process.title} best{_lead(best, ranking[1:])}; max|S| "
        f"is {best.maximum_sensitivity:.2f}; {watch}."
    )


def _lead(best: Candidate, others: Sequence[Candidate]) -> str:
    """Return what decided between the winner and the next, by the rule of the ranking."""
    if not others:
        return ""
    rival = others[0]
    name = rival.controller.name
    if best.standing is not rival.standing:
        return f", {_STANDINGS[best.standing]} where {name} is not"
    if rival.mean_error > _TIE * best.mean_error:
        saved = 100 * (1 - best.mean_error / rival.mean_error)
        return f", with an integral absolute error {saved:.0f} % below that of {name}"
    return f", as precise as {name} with less movement of the inputs"


def _ratio(value: float, best: float) -> float:
    if math.isinf(value):
        return math.inf
    return value / best if best > 0 else (1.0 if value == 0 else math.inf)


def _reason(trial: Trial, error: float, wear: float) -> str:
    standing = {
        Standing.ROBUST: f"robust (max|S| {trial.maximum_sensitivity:.2f})",
        Standing.STABLE: f"stable with thin margins (max|S| {trial.maximum_sensitivity:.2f})",
        Standing.UNSAFE: (
            "unstable by its linear model"
            if not math.isfinite(trial.maximum_sensitivity)
            else "a level leaves its tank"
        ),
    }[trial.standing]
    words = (
        standing[0].upper() + standing[1:],
        _compared(error, "smallest integral absolute error"),
        _compared(wear, "least total variation"),
    )
    return "; ".join(words) + "."


def _compared(ratio: float, best: str) -> str:
    return f"the {best}" if ratio < 1.005 else f"{ratio:.2f} times the {best}"
