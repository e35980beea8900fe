"""A study: every controller asked for, designed, tuned, simulated, scored and ranked."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import studied_designs
from clepsydra.studies.file.request import ControllerRequest, Maker, StudyRequest
from clepsydra.studies.ranking import Trial, rank, rule_of, verdict
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.trial import trial_of
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import GENERATIONS, Progress, Search
from clepsydra.studies.usual_tuning import UsualTuning

#: Bounds of max|S| at which the front of score against robustness is refined.
FRONT = (1.2, 1.4, 1.7, 2.0)


class StudyProgress(NamedTuple):
    """How far a study has come.

    Parameters
    ----------
    done, of : int
        Controllers.
    name : str
        The one in work, and what is done with it.
    trials : tuple of Trial
        Those that are done.
    scores : tuple of str
        What they are judged by; empty for the usual.
    """

    done: int
    of: int
    name: str
    trials: tuple[Trial, ...] = ()
    scores: tuple[str, ...] = ()

    @property
    def ranking(self) -> tuple[Candidate, ...]:
        """What is done, ranked."""
        return rank(self.trials, self.scores)


def run_study(
    process: Process | StudyRequest | str | Path,
    *,
    seed: int = 1,
    progress: Callable[[StudyProgress], None] | None = None,
    tuning_folder: Path | None = None,
    only: str | None = None,
) -> StudyResult:
    """Design, tune, simulate, score and rank controllers of a process.

    Parameters
    ----------
    process : Process, StudyRequest, str or Path
        A process, a name of the catalogue or a process file: every design that applies is
        tried in the default scenario, and PI control is tuned by simulation. Or a study file,
        read by `studies.file.reader.read_study`, which says what is tried.
    seed : int
        Of the measurement noise and the tuning; that of a study file stands in the file.
    progress : callable, optional
        Takes a `StudyProgress` before each controller, and while one is tuned.
    tuning_folder : Path, optional
        Where a tuning keeps what it has computed until it is done. Control-C ends a tuning with
        the best so far; the same study then goes on from there.
    only : str, optional
        Name of the one controller that is wanted, from `controller_names`; the others are left
        out, but for the one that its tuning starts from.

    Raises
    ------
    NoEquilibrium
        The process has no operating point.
    InputError
        The process or study file cannot be used, the process is sampled too slowly or too
        fast to be simulated, or `only` names no controller of the study.

    Examples
    --------
    >>> (candidate,) = run_study("three-tanks", only="PI, AMIGO").ranking
    >>> candidate.standing.name, round(candidate.maximum_sensitivity, 2)
    ('ROBUST', 1.36)
    """
    if not isinstance(process, (Process, StudyRequest)):
        process = load_process(process)
    if only is not None:
        _check_name(only, controller_names(process))
    request = process if isinstance(process, StudyRequest) else _usual_request(process, seed)
    return _Study(request, progress, tuning_folder).run(only)


def controller_names(request: Process | StudyRequest) -> tuple[str, ...]:
    """Return the names of the controllers that a study tries, whether or not they apply."""
    if isinstance(request, StudyRequest) and request.controllers:
        return tuple(wanted.name for wanted in request.controllers)
    process = request.process if isinstance(request, StudyRequest) else request
    return (*studied_designs(), UsualTuning(process, ()).name)


def _usual_request(process: Process, seed: int) -> StudyRequest:
    """Return the request for all designs in the default scenario."""
    analysis = analyse(process)
    substeps_for(analysis.model)  # a process that cannot be simulated is refused before all else
    scenario = default_scenario(analysis.model, seed=seed)
    return StudyRequest(None, process.title, process, analysis, scenario, (), (), seed)


def _check_name(name: str, known: tuple[str, ...]) -> None:
    if name not in known:
        listed = f"choose one, in quotation marks: {'; '.join(known)}"
        remedy = suggestion(name, known, listed)
        raise InputError("controller", name, "the name of a controller of this study", remedy)


class _Study:
    def __init__(
        self,
        request: StudyRequest,
        progress: Callable[[StudyProgress], None] | None,
        tuning_folder: Path | None,
    ) -> None:
        self.request, self.analysis, self.scenario = request, request.analysis, request.scenario
        self.model: LinearModel = linearise(self.analysis.operating_point)
        self.tell = progress or (lambda _: None)
        self.folder = tuning_folder
        self.trials: list[Trial] = []

    def run(self, only: str | None) -> StudyResult:
        """Try every controller that is wanted, and rank what applies."""
        request, wanted, refused = self.request, self._wanted(only), []
        for place, each in enumerate(wanted):
            trials = tuple(self.trials)
            now = StudyProgress(place, len(wanted), each.name, trials, request.scores)
            self.tell(now)
            try:
                self._try(each, now)
            except NotApplicable as refusal:
                refused.append((each.name, refusal.reason))
        ranking = rank(self.trials, request.scores)
        return StudyResult(
            process=request.process,
            analysis=self.analysis,
            scenario=self.scenario,
            ranking=ranking,
            not_applicable=tuple(refused),
            verdict=verdict(request.process, ranking),
            warnings=self.analysis.operating_point.warnings,
            title=request.title,
            rule=rule_of(request.scores),
            path=request.path,
        )

    def _wanted(self, only: str | None) -> list[ControllerRequest]:
        """Return what is asked for, or every design and the usual tuning; or one and its start."""
        needed, wanted = {only}, list(self.request.controllers)
        if not wanted:
            usual = UsualTuning(self.request.process, self.trials)
            needed |= {usual.first} if only == usual.name else set()
            wanted = [
                ControllerRequest(name, _made_by(design), None)
                for name, design in studied_designs().items()
            ]
            wanted.append(ControllerRequest(usual.name, usual.make, usual))
        return [each for each in wanted if only is None or each.name in needed]

    def _try(self, wanted: ControllerRequest, now: StudyProgress) -> None:
        controller, tuning = wanted.make(self.analysis, self.model), None
        if wanted.tune is not None:
            run = partial(wanted.tune.run, controller, self.model, self.scenario)
            tuning = self._tuned(now, run)
            controller = replace(tuning.controller, name=wanted.name)
        self.trials.append(trial_of(controller, self.analysis, self.model, self.scenario, tuning))

    def _tuned(self, now: StudyProgress, run: Callable[[Search], TuningResult]) -> TuningResult:
        def tell(progress: Progress) -> None:
            words = f"{now.name}: {progress.stage}, {progress.evaluations} candidates"
            self.tell(now._replace(name=words))

        kept = None
        if self.folder is not None:
            name = re.sub(r"[^A-Za-z0-9]+", "-", now.name).strip("-").lower()
            kept = self.folder / f"{self.request.file_stem}.{name}.tuning.json"
        try:
            found = run(Search(GENERATIONS, self.request.seed, FRONT, tell, kept))
        except NotApplicable:  # no candidate keeps the limits: nothing is left to go on with
            if kept is not None:
                kept.unlink(missing_ok=True)
            raise
        if kept is not None and not found.interrupted:
            kept.unlink(missing_ok=True)
        return found


def _made_by(design: Callable[[Analysis], Controller]) -> Maker:
    return lambda analysis, model: design(analysis)
