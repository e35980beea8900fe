"""What a study file asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

from clepsydra.controllers.controller import Controller
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel

if TYPE_CHECKING:
    from clepsydra.linear.equilibrium_request import Asked
    from clepsydra.loop.scenario import Scenario
    from clepsydra.process.process import Process
    from clepsydra.studies.tuning.result import TuningResult
    from clepsydra.studies.tuning.tune import Search

#: Which designs stand beside the controllers that a file names.
Designs = Literal["none", "all"]
#: Whether controllers keep their settings in a case, or are designed for it.
Settings = Literal["frozen", "designed_anew"]
#: Takes the analysis of the process and its linear model with all measurements.
Maker = Callable[[Analysis, LinearModel], Controller]


class Tuner(Protocol):
    """What tunes a controller by simulation."""

    @property
    def asked(self) -> object:
        """What tells it from any other that tunes the same controller; None if nothing does."""

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Return what became of it."""


@dataclass(frozen=True, eq=False)
class ControllerRequest:
    """One controller of a study file.

    Parameters
    ----------
    name : str
        As the reader sees it.
    make : callable
        (analysis, model) → Controller. It raises `NotApplicable` where a design does not apply
        to the process, and an `InputError` that names line and key where the file is wrong. What
        is asked of a tuning is checked as well.
    tune : Tuner or None
        How it is tuned by simulation after that; None if it is not.
    asked : object
        What tells `make` from any other of the same plant; None if nothing does.
    """

    name: str
    make: Maker
    tune: Tuner | None
    asked: object = None


@dataclass(frozen=True, eq=False)
class StudyRequest:
    """A study as its file asks for it.

    Parameters
    ----------
    path : Path or None
        Of the file; None where there is none.
    title : str
        One line for the reader.
    analysis : Analysis
        Of the process at its operating point, where the scenario begins.
    controllers : tuple of ControllerRequest
        In the order of the file; empty where it names none.
    scores : tuple of str
        What to rank by, from `clepsydra.scores.catalogue`: "iae" of all its signals or
        "iae[level]" of one; empty for the usual rule.
    seed : int
        Of noise and searches.
    designs : {"none", "all"}
        Whether every design that applies is wanted beside those that are named.
    cases : tuple of CaseRequest
        The other operating points and variants at which its controllers are tried.
    """

    path: Path | None
    title: str
    process: Process
    analysis: Analysis
    scenario: Scenario
    controllers: tuple[ControllerRequest, ...]
    scores: tuple[str, ...]
    seed: int
    designs: Designs = "none"
    cases: tuple[CaseRequest, ...] = ()

    @property
    def tries_every_design(self) -> bool:
        """Whether every design that applies is wanted, as where no controller is named."""
        return self.designs == "all" or not self.controllers

    @property
    def file_stem(self) -> str:
        """What reports and data of the study are called: the file's own name.

        >>> StudyRequest(Path("a/basin.toml"), "", *[None] * 3, (), (), 1).file_stem
        'basin'
        """
        return self.process.file_stem if self.path is None else self.path.stem


@dataclass(frozen=True, eq=False)
class CaseRequest:
    """Another operating point, or another variant, at which the controllers of a study are tried.

    Parameters
    ----------
    name : str
        As the reader sees it.
    settings : {"frozen", "designed_anew"}
        Whether controllers keep the settings of the study, or are designed and tuned for the case.
    study : StudyRequest
        Of the process there, in the same scenario.
    asked : mapping
        What fixes the operating point there: "inputs", "outputs" and "disturbances" to values by
        name [SI], or None for those of the process.
    """

    name: str
    settings: Settings
    study: StudyRequest
    asked: Asked = field(default_factory=dict)
