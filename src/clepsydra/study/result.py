"""What a study found."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process


@dataclass(frozen=True)
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
    rank: int
    reason: str
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class StudyResult:
    """A process, its analysis, and the controllers in order of rank.

    Parameters
    ----------
    process : Process
    point : OperatingPoint
    model : LinearModel
    scenario : Scenario
    ranking : tuple of Candidate
        Best first.
    not_applicable : tuple of (name, reason)
    verdict : str
        The answer in one sentence: which controller, how good, how sure, what to watch.
    warnings : tuple of str
    """

    process: Process
    point: OperatingPoint
    model: LinearModel
    scenario: Scenario
    ranking: tuple[Candidate, ...]
    not_applicable: tuple[tuple[str, str], ...]
    verdict: str
    warnings: tuple[str, ...]
