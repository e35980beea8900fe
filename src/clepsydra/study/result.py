"""What a study found."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import IntEnum
from typing import Any

from clepsydra.controllers.controller import Controller
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process


class Standing(IntEnum):
    """How far a controller can be trusted; a smaller number ranks first."""

    ROBUST = 0
    STABLE = 1
    UNSAFE = 2


@dataclass(frozen=True, eq=False)
class Candidate:
    """One controller of a study with its run, its scores and its place.

    Parameters
    ----------
    controller : Controller
    run : Run
    scores : dict
        Score name to value; a score per signal has the key "name[signal]".
    maximum_sensitivity : float
        Largest singular value of S over frequency, at the process output.
    standing : Standing
    mean_error : float
        Mean over the controlled variables of the integral absolute error, each as a multiple
        of the best in the study.
    rank : int
        1 is best.
    reason : str
        Why it stands where it stands, one sentence.
    warnings : tuple of str
    """

    controller: Controller
    run: Run
    scores: dict[str, float]
    maximum_sensitivity: float
    standing: Standing
    mean_error: float
    rank: int
    reason: str
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class StudyResult:
    """A process, its analysis, and the controllers in order of rank.

    Parameters
    ----------
    process : Process
    analysis : Analysis
    scenario : Scenario
    ranking : tuple of Candidate
        Best first.
    not_applicable : tuple of (name, reason)
    verdict : str
        The answer in one sentence: which controller, how good, how sure, what to watch.
    warnings : tuple of str
        What holds for the process under any controller.
    """

    process: Process
    analysis: Analysis
    scenario: Scenario
    ranking: tuple[Candidate, ...]
    not_applicable: tuple[tuple[str, str], ...]
    verdict: str
    warnings: tuple[str, ...]

    @property
    def point(self) -> OperatingPoint:
        """The operating point."""
        return self.analysis.operating_point

    @property
    def model(self) -> LinearModel:
        """The linear model from all inputs to the controlled outputs."""
        return self.analysis.model

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
            },
        }


def _candidate(candidate: Candidate) -> dict[str, Any]:
    controller, run = candidate.controller, candidate.run
    return {
        "rank": candidate.rank,
        "standing": candidate.standing.name.lower(),
        "controller": controller.name,
        "family": controller.family,
        "design": controller.design,
        "parameters": dict(controller.values),
        "pairing": list(zip(controller.setpoints, controller.manipulated, strict=True)),
        "scores": dict(candidate.scores),
        "maximum_sensitivity": candidate.maximum_sensitivity,
        "reason": candidate.reason,
        "warnings": list(candidate.warnings),
        "error_estimate": run.error_estimate,
        "substeps": run.substeps,
    }
