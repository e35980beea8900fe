"""What a study found."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.remark import Remark as Remark
from clepsydra.studies.warnings.caveat import Caveat, told_once

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.limits.limits import Limits
    from clepsydra.linear.analysis import Analysis
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.linear.operating_point import OperatingPoint
    from clepsydra.loop.run import Run
    from clepsydra.loop.scenario import Scenario
    from clepsydra.process.process import Process
    from clepsydra.studies.file.request import Settings
    from clepsydra.studies.tuning.result import TuningResult
    from clepsydra.studies.warnings.loop_response import LoopResponse

#: The study's own operating point, beside its cases.
BASE_CASE = "base case"
#: The relative error that is good enough beside the best.
ACCEPTED = 1.5


class Standing(IntEnum):
    """How far a controller can be trusted; a smaller number ranks first; OUTSIDE leaves a band."""

    ROBUST = 0
    NERVOUS = 1
    STABLE = 2
    OUTSIDE = 3
    UNSAFE = 4


@dataclass(frozen=True)
class DrawnError:
    """What becomes of a controller on plants that are not quite the one on paper.

    Parameters
    ----------
    draws : int
        How many with a steady state it met; 0 where that would take too long.
    worst : float
        Its error on the worst of them, as a multiple of what it is on paper.
    unsettled : int
        On how many it does not settle, or harms the plant.
    """

    draws: int
    worst: float = math.nan
    unsettled: int = 0


@dataclass(frozen=True, eq=False)
class TriedController:
    """One controller of a study with its run and its scores.

    Parameters
    ----------
    scores : dict
        Score name to value; a score per signal has the key "name[signal]".
    maximum_sensitivity : float
        Largest singular value of S over frequency, at the process output; not a number for a
        controller without setpoints, which has no linear loop.
    warnings : tuple of str
        What there is to watch with the controller.
    caveats : tuple of Caveat
        What the simulation and the scenario leave open, which no controller is to blame for.
    response : LoopResponse or None
        Sensitivity and margins of its exact sampled loop, where it has one.
    tuning : TuningResult or None
        How it was tuned by simulation, if it was.
    overshoots : tuple of Remark
        By how much it overshoots a setpoint, where that is worth watching, and what helps.
    """

    controller: Controller
    run: Run
    scores: dict[str, float]
    maximum_sensitivity: float
    warnings: tuple[Remark, ...]
    caveats: tuple[Caveat, ...] = ()
    response: LoopResponse | None = None
    tuning: TuningResult | None = None
    overshoots: tuple[Remark, ...] = ()

    @property
    def inner_peak(self) -> tuple[str, float] | None:
        """The inner loop with the largest max|S|, and that; None without inner loops."""
        return self.response.inner_peak if self.response else None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Candidate(TriedController):
    """A controller that was tried, and its place in the ranking.

    Parameters
    ----------
    mean_error : float
        What decides among controllers of one standing: the mean of `criteria`.
    rank : int
        1 is best.
    relative_error : float
        `mean_error` as a multiple of that of the first of the ranking.
    reason : str
        Why it stands where it stands, in words.
    criteria : mapping
        What it is judged by, in the words of a column's title, to the mean over its signals of
        that score, each as a multiple of the best in the study: "setpoint error" and "load
        error", for averaging levels "outflow change" and "outflow variance".
    wear : float
        Mean over the manipulated variables of the total variation, each as a multiple of the
        best; it decides between controllers within 2 % of each other.
    cases : mapping
        Of a study of several cases: the base case and each other one to the candidate that it is
        there, None where it does not apply. What it is judged by then is that of its worst case.
    drawn : DrawnError or None
        What became of it on drawn plants; None where it met none.
    """

    standing: Standing
    mean_error: float
    rank: int = 0
    relative_error: float = 1.0
    reason: str = ""
    criteria: Mapping[str, float] = field(default_factory=dict)
    wear: float = 1.0
    cases: Mapping[str, Candidate | None] = field(default_factory=dict)
    drawn: DrawnError | None = None

    def __repr__(self) -> str:
        """Return its place and the numbers of the ranking, in a line."""
        judged = ", ".join(f"{title} {value:.3g}" for title, value in self.criteria.items())
        return (
            f"<Candidate {self.rank}: {self.controller.title}; {self.standing.name.lower()}, "
            f"max|S| {self.maximum_sensitivity:.2f}; {judged or 'not judged'} times the best, "
            f"moves {self.wear:.3g} times the least; {_counted(len(self.warnings), 'warning')}>"
        )


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult:
    """A process, its analysis, and the controllers in order of rank.

    Parameters
    ----------
    ranking : tuple of Candidate
        Best first.
    verdict : str
        The answer in one sentence: which controller, how good, how sure, what to watch.
    warnings : tuple of str
        What holds for the process under any controller.
    title : str
        That of the study file; else that of the process.
    rule : str
        What the controllers are ranked by, in words.
    path : Path or None
        Of the study file; None where there is none.
    accept : float
        The relative error that is good enough.
    out_of_reach : tuple of Remark
        Those of the warnings that say which final element cannot give what the scenario asks.
    judged_by : tuple of str
        The scores that the study asked for; empty for the usual ones.
    cases : mapping
        Name of each other operating point or variant to what was found there.
    settings : {"frozen", "designed_anew"}
        Of a case: whether its controllers have the settings of the study, or its own.
    limits : Limits or None
        The least errors that any controller could leave in its scenario, where they were sought.
    """

    process: Process
    analysis: Analysis
    scenario: Scenario
    ranking: tuple[Candidate, ...]
    not_applicable: tuple[tuple[str, str], ...]
    verdict: str
    warnings: tuple[Remark, ...]
    title: str = ""
    rule: str = ""
    path: Path | None = None
    accept: float = ACCEPTED
    out_of_reach: tuple[Remark, ...] = ()
    judged_by: tuple[str, ...] = ()
    cases: Mapping[str, StudyResult] = field(default_factory=dict)
    settings: Settings = "designed_anew"
    limits: Limits | None = None

    def __repr__(self) -> str:
        """Return what was studied and what came first, in a line."""
        best = f", best {self.ranking[0].controller.title}" if self.ranking else ""
        return (
            f"<StudyResult of {self.process.address}: "
            f"{_counted(len(self.ranking), 'controller')}{best}; "
            f"{len(self.not_applicable)} not applicable>"
        )

    def __str__(self) -> str:
        """Return the verdict and the ranking, a line each."""
        return "\n".join([self.verdict, *(repr(candidate) for candidate in self.ranking)])

    @property
    def point(self) -> OperatingPoint:
        """The operating point."""
        return self.analysis.operating_point

    @property
    def model(self) -> LinearModel:
        """The linear model from all inputs to the controlled outputs."""
        return self.analysis.model

    @property
    def caveats(self) -> tuple[str, ...]:
        """What simulations and scenario leave open, each once, with whom it is true of."""
        return told_once((each.controller.title, each.caveats) for each in self.ranking)

    def as_dict(self) -> dict[str, Any]:
        """Return the study as values for JSON, in SI; an unreached score is infinite."""
        return {
            "process": self.process.name,
            "verdict": self.verdict,
            "ranking": [_candidate(candidate) for candidate in self.ranking],
            "not_applicable": [
                {"controller": name, "reason": reason} for name, reason in self.not_applicable
            ],
            "warnings": list(self.warnings),
            "analysis": self.analysis.as_dict(),
            "scenario": {
                "sampling_period": self.scenario.sampling_period,
                "samples": self.scenario.samples,
                "seed": self.scenario.seed,
                "segments": [asdict(segment) for segment in self.scenario.segments],
                **({} if self.scenario.begin is None else self.scenario.begin.as_dict()),
            },
            **self._cases_as_dict(),
            **self._limits_as_dict(),
        }

    def times_limit(self, candidate: Candidate) -> float | None:
        """Return the setpoint error of a controller as a multiple of the least possible.

        It is None where the limit was not sought, or there is none.
        """
        return None if self.limits is None else self.limits.times(candidate.run)

    def _limits_as_dict(self) -> dict[str, Any]:
        """Return the physical limit, and how many times it each controller is."""
        if self.limits is None:
            return {}
        times = {each.controller.name: self.times_limit(each) for each in self.ranking}
        return {"limit": {**self.limits.as_dict(courses=False), "times": times}}

    def _cases_as_dict(self) -> dict[str, Any]:
        """Return each case as a study of its own; nothing where there is none."""
        if not self.cases:
            return {}
        return {
            "cases": {
                name: {"settings": each.settings, "address": each.process.address, **each.as_dict()}
                for name, each in self.cases.items()
            }
        }


def _counted(number: int, what: str) -> str:
    return f"{number or 'no'} {what}{'' if number == 1 else 's'}"


def _candidate(candidate: Candidate) -> dict[str, Any]:
    # With a run alone: what makes a design loads no loop.
    from clepsydra.loop.alarm_times import alarms_as_dict

    controller, run = candidate.controller, candidate.run
    return {
        "rank": candidate.rank,
        "standing": candidate.standing.name.lower(),
        "controller": controller.name,
        "title": controller.title,
        "slowed": controller.slowed,
        "family": controller.family,
        "design": controller.design,
        "complexity": controller.complexity.words,
        "parameters": dict(controller.values),
        "measurements": list(controller.measurements),
        "setpoints": list(controller.setpoints),
        "manipulated": list(controller.manipulated),
        "scores": dict(candidate.scores),
        "maximum_sensitivity": candidate.maximum_sensitivity,
        "mean_error": candidate.mean_error,
        "relative_error": candidate.relative_error,
        "criteria": dict(candidate.criteria),
        "wear": candidate.wear,
        "reason": candidate.reason,
        "warnings": list(candidate.warnings),
        "caveats": [each.words for each in candidate.caveats],
        "error_estimate": run.error_estimate,
        "substeps": run.substeps,
        **alarms_as_dict(run),
        **_cases(candidate),
        **({} if candidate.drawn is None else {"drawn": asdict(candidate.drawn)}),
    }


def _cases(candidate: Candidate) -> dict[str, Any]:
    """Return how a candidate stands in each case; nothing where there is none."""
    if not candidate.cases:
        return {}
    return {
        "cases": {
            name: None
            if each is None
            else {
                "standing": each.standing.name.lower(),
                "mean_error": each.mean_error,
                "maximum_sensitivity": each.maximum_sensitivity,
                "scores": dict(each.scores),
            }
            for name, each in candidate.cases.items()
        }
    }
