"""A study: every controller asked for, designed, tuned, simulated, scored and ranked."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from clepsydra.base.errors import InputError
from clepsydra.base.standing import Standing, standing_at
from clepsydra.base.suggestion import nearest_few
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.linearise import linearise
from clepsydra.loop.run_cost import weigh_run
from clepsydra.loop.step_size import substeps_for
from clepsydra.studies.designs import studied_designs
from clepsydra.studies.file.request import ControllerRequest, Maker, StudyRequest, Tuner
from clepsydra.studies.kept_work import KeptWork
from clepsydra.studies.long_runs import LongRuns
from clepsydra.studies.ranking import Trial, rank, rule_of, verdict
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.trial import trial_of
from clepsydra.studies.usual_tuning import usual_tunings
from clepsydra.studies.warnings.out_of_reach import out_of_reach

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.analysis import Analysis
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.process.process import Process
    from clepsydra.studies.tuning.result import TuningResult
    from clepsydra.studies.tuning.tune import Progress

#: Who names the state file of a tuning, for messages.
_TUNING = "tuning, state file"
#: Names of controllers that a refusal shows.
_NAMES_SAID = 8

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
    request: StudyRequest,
    *,
    progress: Callable[[StudyProgress], None] | None = None,
    tuning_folder: Path | None = None,
    only: str | None = None,
) -> StudyResult:
    """Design, tune, simulate, score and rank controllers of a process.

    Parameters
    ----------
    request : StudyRequest
        Where it names no controllers, every design that applies is tried, and PI and PID
        control are tuned by simulation.
    progress : callable, optional
        Takes a `StudyProgress` before each controller, and while one is tuned.
    tuning_folder : Path, optional
        Where a tuning keeps what it has computed until it is done. Control-C ends a tuning with
        the best so far; the same study then goes on from there.
    only : str, optional
        Name of the one controller that is wanted, from `controller_names`; the others are left
        out, but for those that its tuning starts from.

    Raises
    ------
    InputError
        A controller of the request cannot be made, or `only` names none of the study.
    """
    known = controller_names(request)
    if only is not None and only not in known:
        raise _unknown_controller(only, known, written_out=bool(request.controllers))
    return _Study(request, progress, tuning_folder).run(only)


def _unknown_controller(name: str, known: Sequence[str], *, written_out: bool) -> InputError:
    """Return the refusal of a name: those that are near, or the first few, and where others are."""
    near = " or ".join(f"'{each}'" for each in nearest_few(name, known))
    if near:
        expected = "the name of a controller of this study"
        remedy = f"perhaps {near} was meant; the whole study lists every one"
        return InputError("controller", name, expected, remedy)
    more = len(known) - _NAMES_SAID
    expected = " or ".join(f"'{each}'" for each in known[:_NAMES_SAID])
    expected += f" or one of {more} more of this study" if more > 0 else ""
    remedy = "choose one of them; the whole study lists every one"
    if not written_out:
        remedy += (
            ". A scheme of loops, as a cascade, has its name in a study file that writes it out: "
            "give that file instead of the process"
        )
    return InputError("controller", name, expected, remedy)


def controller_names(request: Process | StudyRequest) -> tuple[str, ...]:
    """Return the names of the controllers that a study tries, whether or not they apply."""
    if isinstance(request, StudyRequest) and request.controllers:
        return tuple(wanted.name for wanted in request.controllers)
    process = request.process if isinstance(request, StudyRequest) else request
    return (*studied_designs(), *(each.name for each in usual_tunings(process, ())))


class _Study:
    def __init__(
        self,
        request: StudyRequest,
        progress: Callable[[StudyProgress], None] | None,
        tuning_folder: Path | None,
    ) -> None:
        self.request = request
        self.model: LinearModel = linearise(request.analysis.operating_point)
        weigh_run(request.process, request.scenario.samples, substeps_for(self.model))
        self.tell = progress or (lambda _: None)
        self.folder = tuning_folder
        self.kept = KeptWork(request.analysis.operating_point)
        self.trials: list[Trial] = []
        self.long_runs = LongRuns(self.model, request.scenario)
        self._designs: dict[ControllerRequest, Controller | NotApplicable] = {}

    def run(self, only: str | None) -> StudyResult:
        """Try every controller that is wanted, and rank what applies."""
        request, wanted, refused = self.request, self._wanted(only), []
        for place, each in enumerate(wanted):
            trials = tuple(self.trials)
            now = StudyProgress(place, len(wanted), each.name, trials, request.scores)
            self.tell(now)
            try:
                self._try(each, now, wanted[place + 1 :])
            except NotApplicable as refusal:
                refused.append((each.name, refusal.reason))
        ranking = rank(self.trials, request.scores)
        beyond = out_of_reach(self.model, request.scenario)
        return StudyResult(
            process=request.process,
            analysis=request.analysis,
            scenario=request.scenario,
            ranking=ranking,
            not_applicable=tuple(refused),
            verdict=verdict(request.process, ranking, out_of_reach=beyond),
            warnings=(*beyond, *request.analysis.operating_point.warnings),
            out_of_reach=beyond,
            title=request.title,
            rule=rule_of(request.scores),
            path=request.path,
            judged_by=tuple(request.scores),
        )

    def _wanted(self, only: str | None) -> list[ControllerRequest]:
        """Return what is asked for, or all designs and the usual tunings; or one and its starts."""
        needed, wanted = {only}, list(self.request.controllers)
        if not wanted:
            usual = usual_tunings(self.request.process, self.trials)
            for each in reversed(usual):  # one starts from another that stands before it
                needed |= {each.first} if each.name in needed else set()
            wanted = [
                ControllerRequest(name, _made_by(each), None, each.asked)
                for name, each in studied_designs().items()
            ]
            wanted += [ControllerRequest(each.name, each.make, each) for each in usual]
        return [each for each in wanted if only is None or each.name in needed]

    def _try(
        self, wanted: ControllerRequest, now: StudyProgress, later: Sequence[ControllerRequest]
    ) -> None:
        controller, tuning = self._designed(wanted), None
        if wanted.tune is not None:
            tuning = self._tuned(now, wanted.tune, controller)
            controller = replace(tuning.controller, name=wanted.name)
        run = self.long_runs.of(controller, self._applying(later))
        self.trials.append(trial_of(controller, self.model, self.request.scenario, tuning, run))

    def _designed(self, wanted: ControllerRequest) -> Controller:
        if wanted not in self._designs:
            make = partial(wanted.make, self.request.analysis, self.model)
            try:
                self._designs[wanted] = self.kept.outcome(wanted.asked, make)
            except NotApplicable as refusal:
                self._designs[wanted] = refusal
        found = self._designs[wanted]
        if isinstance(found, NotApplicable):
            raise found
        return found

    def _applying(self, later: Sequence[ControllerRequest]) -> Iterator[Controller]:
        """Yield the controllers that come next without a tuning, as far as they apply."""
        for each in later:
            if each.tune is None:
                with suppress(NotApplicable):
                    yield self._designed(each)

    def _tuned(self, now: StudyProgress, tuner: Tuner, controller: Controller) -> TuningResult:
        state = None
        if self.folder is not None:
            name = re.sub(r"[^A-Za-z0-9]+", "-", now.name).strip("-").lower()
            state = self.folder / f"{self.request.file_stem}.{name}.tuning.json"
        asked = tuner.asked
        if asked is not None:
            asked = asked, controller, self.request.scenario, self.request.seed, FRONT
        if state is not None and standing_at(state, _TUNING, "its state") is not Standing.NOTHING:
            asked = None  # an interrupted tuning goes on, or says that it does not
        return self.kept.outcome(
            asked,
            lambda: self._tune(now, tuner, controller, state),
            lasts=lambda found: not found.interrupted,
        )

    def _tune(
        self, now: StudyProgress, tuner: Tuner, controller: Controller, state: Path | None
    ) -> TuningResult:
        """Tune a controller, with what is computed kept in a file until it is done."""
        from clepsydra.studies.tuning.tune import Search

        def tell(progress: Progress) -> None:
            words = f"{now.name}: {progress.stage}, {progress.evaluations} candidates"
            self.tell(now._replace(name=words))

        search = Search(None, self.request.seed, FRONT, tell, state, afresh=True)
        try:
            found = tuner.run(controller, self.model, self.request.scenario, search)
        except NotApplicable:  # no candidate keeps the limits: nothing is left to go on with
            if state is not None:
                state.unlink(missing_ok=True)
            raise
        if state is not None and not found.interrupted:
            state.unlink(missing_ok=True)
        return found


def _made_by(design: Callable[[Analysis], Controller]) -> Maker:
    return lambda analysis, model: design(analysis)
