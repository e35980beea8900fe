"""A study: every controller asked for, designed, tuned, simulated, scored and ranked."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import studied_designs
from clepsydra.studies.file.request import StudyRequest
from clepsydra.studies.levels_used import levels_used
from clepsydra.studies.ranking import QUIET, Trial, of_averaging, rank, rule_of, verdict
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.trial import trial_of
from clepsydra.studies.tuning.goal import Goal
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Limits, Objective, minimax, weighted_sum
from clepsydra.studies.tuning.parameters import gains_and_times
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import GENERATIONS, Progress, Search, tune

#: The design whose controller a study tunes, that of levels which average, and what the reader
#: calls the result.
_START, _AVERAGING_START, _TUNED = "PI, SIMC", "PI, arrest time", "{}, tuned"
#: A tuned controller may have this many times the total variation of its start, or as much as
#: leaves this share of the noise movement of a quiet one: noise makes most of the moves.
_WEAR, _OF_QUIET = 2.0, 0.9
#: The global search of a tuning that nobody asked for simulates about so many samples of each
#: candidate in all, but has at least so many generations.
_SIMULATED, _FEWEST = 400_000, 8
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

    Examples
    --------
    >>> StudyProgress(3, 15, "PI, SIMC").name
    'PI, SIMC'
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

    Returns
    -------
    StudyResult

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
    if isinstance(process, StudyRequest):
        study = _Study(process.analysis, process.scenario, process.seed, progress, tuning_folder)
        return study.of_request(process, only).result()
    analysis = analyse(process)
    substeps_for(analysis.model)  # a process that cannot be simulated is refused before all else
    scenario = default_scenario(analysis.model, seed=seed)
    return _Study(analysis, scenario, seed, progress, tuning_folder).of_all_designs(only).result()


def controller_names(request: Process | StudyRequest) -> tuple[str, ...]:
    """Return the names of the controllers that a study tries, whether or not they apply.

    Examples
    --------
    >>> controller_names(load_process("equalisation-tank"))[-1]
    'PI, arrest time, tuned'
    """
    if isinstance(request, StudyRequest) and request.controllers:
        return tuple(wanted.name for wanted in request.controllers)
    process = request.process if isinstance(request, StudyRequest) else request
    return (*studied_designs(), _TUNED.format(_first(process)))


def _first(process: Process) -> str:
    """Return the design whose controller is tuned."""
    return _AVERAGING_START if process.averaging else _START


def _check_name(name: str, known: tuple[str, ...]) -> None:
    if name not in known:
        listed = f"choose one, in quotation marks: {'; '.join(known)}"
        remedy = suggestion(name, known, listed)
        raise InputError("controller", name, "the name of a controller of this study", remedy)


class _Study:
    def __init__(
        self,
        analysis: Analysis,
        scenario: Scenario,
        seed: int,
        progress: Callable[[StudyProgress], None] | None,
        tuning_folder: Path | None,
    ) -> None:
        self.analysis, self.scenario, self.seed = analysis, scenario, seed
        self.process = analysis.operating_point.process
        self.model: LinearModel = linearise(analysis.operating_point)
        self.tell = progress or (lambda _: None)
        self.folder = tuning_folder
        self.stem = self.process.file_stem
        self.trials: list[Trial] = []
        self.refused: list[tuple[str, str]] = []
        self.scores: tuple[str, ...] = ()
        self.title = self.process.title
        self.path: Path | None = None

    def of_request(self, request: StudyRequest, only: str | None) -> _Study:
        self.stem, self.scores, self.title = request.file_stem, request.scores, request.title
        self.path = request.path
        if not request.controllers:
            return self.of_all_designs(only)
        chosen = [each for each in request.controllers if only in (None, each.name)]
        for place, wanted in enumerate(chosen):
            now = self._begin(place, len(chosen), wanted.name)
            with self._refusals(wanted.name):
                controller = wanted.make(self.analysis, self.model)
                tuning = None
                if wanted.tune is not None:
                    run = partial(wanted.tune.run, controller, self.model, self.scenario)
                    tuning = self._tuned(now, run)
                    controller = replace(tuning.controller, name=wanted.name)
                self._add(controller, tuning)
        return self

    def of_all_designs(self, only: str | None) -> _Study:
        first = _first(self.process)
        name = _TUNED.format(first)
        designs = studied_designs()
        if only is not None:
            chosen = first if only == name else only
            designs = {chosen: designs[chosen]}
        for place, (each, design) in enumerate(designs.items()):
            self._begin(place, len(designs) + 1, each)
            with self._refusals(each):
                self._add(design(self.analysis))
        if only not in (None, name):
            return self
        now = self._begin(len(designs), len(designs) + 1, name)
        with self._refusals(name):
            start, objective, limits = self._start(first, name)
            generations = max(_FEWEST, min(GENERATIONS, round(_SIMULATED / self.scenario.samples)))
            space = LawSpace(start, gains_and_times(start))
            goal = Goal(self.model, self.scenario, objective, limits)
            tuning = self._tuned(now, partial(tune, space, goal), generations)
            self._add(tuning.controller, tuning)
        return self

    def _begin(self, done: int, of: int, name: str) -> StudyProgress:
        now = StudyProgress(done, of, name, tuple(self.trials), self.scores)
        self.tell(now)
        return now

    def _add(self, controller: Controller, tuning: TuningResult | None = None) -> None:
        self.trials.append(trial_of(controller, self.analysis, self.model, self.scenario, tuning))

    def _tuned(
        self,
        now: StudyProgress,
        run: Callable[[Search], TuningResult],
        generations: int = GENERATIONS,
    ) -> TuningResult:
        def tell(progress: Progress) -> None:
            words = f"{now.name}: {progress.stage}, {progress.evaluations} candidates"
            self.tell(now._replace(name=words))

        kept = None
        if self.folder is not None:
            name = re.sub(r"[^A-Za-z0-9]+", "-", now.name).strip("-").lower()
            kept = self.folder / f"{self.stem}.{name}.tuning.json"
        try:
            found = run(Search(generations, self.seed, FRONT, tell, kept))
        except NotApplicable:  # no candidate keeps the limits: nothing is left to go on with
            if kept is not None:
                kept.unlink(missing_ok=True)
            raise
        if kept is not None and not found.interrupted:
            kept.unlink(missing_ok=True)
        return found

    def _start(self, first: str, tuned: str) -> tuple[Controller, Objective, Limits]:
        """Return what PI control is tuned from and for, with hardly more wear, and as quiet."""
        start = next((t for t in self.trials if t.controller.name == first), None)
        if start is None:
            raise NotApplicable(f"it starts from {first}, which does not apply")
        noise = max(start.noise_movement, 1e-9)
        more = max(1.0, min(_WEAR, _OF_QUIET * QUIET / noise))
        wear = {
            name: more * start.scores[f"total_variation[{name}]"]
            for name in start.controller.manipulated
        }
        limits = Limits(SENSITIVITY_LIMIT, total_variation=wear)
        if not self.process.averaging:
            errors = [f"iae[{name}]" for name in dict.fromkeys(start.controller.setpoints)]
            return start.controller, minimax(*errors), limits
        free = [name for name in self.process.averaging if name not in self.process.bands]
        limits = replace(limits, levels=levels_used(start.run, free))
        return start.controller, self._averaging_objective(start, tuned), limits

    def _averaging_objective(self, start: Trial, tuned: str) -> Objective:
        """Return the mean of what ranks a process whose levels average, relative to the start."""
        averaging = self.process.averaging
        names = [
            f"{score}[{name}]" for score, levels in of_averaging(self.process) for name in levels
        ]
        names += [f"iae[{name}]" for name in self.process.controlled if name not in averaging]
        names = [name for name in names if start.scores.get(name, 0.0) > 0.0]
        try:
            RunningScores(self.process, tuple(names)).inputs_of(self.scenario)
        except InputError as refusal:
            raise NotApplicable(
                f"what averaging is judged by is not known of {refusal.value}"
            ) from None
        if not names:
            raise NotApplicable(f"{', '.join(averaging)} leave nothing to lessen")
        return weighted_sum(dict.fromkeys(names, 1.0))

    @contextmanager
    def _refusals(self, name: str) -> Iterator[None]:
        """Keep the reason of a controller that does not apply."""
        try:
            yield
        except NotApplicable as refusal:
            self.refused.append((name, refusal.reason))

    def result(self) -> StudyResult:
        ranking = rank(self.trials, self.scores)
        return StudyResult(
            process=self.process,
            analysis=self.analysis,
            scenario=self.scenario,
            ranking=ranking,
            not_applicable=tuple(self.refused),
            verdict=verdict(self.process, ranking),
            warnings=self.analysis.operating_point.warnings,
            title=self.title,
            rule=rule_of(self.scores),
            path=self.path,
        )
