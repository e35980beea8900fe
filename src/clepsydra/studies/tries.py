"""Controllers tried at one operating point: designed, tuned, simulated and scored."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from clepsydra.base.standing import Standing, standing_at
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.linearise import linearise
from clepsydra.loop.run_cost import weigh_run
from clepsydra.loop.step_size import substeps_for
from clepsydra.studies.designs import studied_designs
from clepsydra.studies.file.request import ControllerRequest, Maker, StudyRequest, Tuner
from clepsydra.studies.frozen import frozen_at
from clepsydra.studies.kept_work import KeptWork
from clepsydra.studies.long_runs import LongRuns
from clepsydra.studies.ranking import Trial, rank
from clepsydra.studies.result import Candidate
from clepsydra.studies.trial import trial_of
from clepsydra.studies.usual_tuning import usual_tunings

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.analysis import Analysis
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.studies.tuning.result import TuningResult
    from clepsydra.studies.tuning.tune import Progress

#: Who names the state file of a tuning, for messages.
_TUNING = "tuning, state file"

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


class Tries:
    """The controllers of a study at one operating point, tried one after the other.

    Parameters
    ----------
    request : StudyRequest
    tell : callable
        Takes a `StudyProgress` before each controller, and while one is tuned.
    folder : Path or None
        Where a tuning keeps what it has computed until it is done.
    case : str
        Of what the operating point is; empty for the study itself.

    Attributes
    ----------
    trials : list of Trial
    refused : list of (name, reason)
        What does not apply.
    """

    def __init__(
        self,
        request: StudyRequest,
        tell: Callable[[StudyProgress], None],
        folder: Path | None = None,
        case: str = "",
    ) -> None:
        self.request, self.tell, self.folder, self.case = request, tell, folder, case
        self.model: LinearModel = linearise(request.analysis.operating_point)
        weigh_run(request.process, request.scenario.samples, substeps_for(self.model))
        self.kept = KeptWork(request.analysis.operating_point)
        self.trials: list[Trial] = []
        self.refused: list[tuple[str, str]] = []
        self.long_runs = LongRuns(self.model, request.scenario)
        self._designs: dict[ControllerRequest, Controller | NotApplicable] = {}

    def try_wanted(self, only: str | None = None) -> None:
        """Try every controller that is asked for, or the one of a name and what it starts from."""
        wanted = self._wanted(only)
        for place, each in enumerate(wanted):
            trials = tuple(self.trials)
            now = StudyProgress(place, len(wanted), each.name, trials, self.request.scores)
            self.tell(now)
            try:
                self._try(each, now, wanted[place + 1 :])
            except NotApplicable as refusal:
                self.refused.append((each.name, refusal.reason))

    def try_frozen(self, base: Tries) -> None:
        """Try what was tried at another operating point or variant with the settings it has."""
        frozen = []
        for each in (trial.controller for trial in base.trials):
            try:
                frozen.append(frozen_at(each, base.model, self.model))
            except NotApplicable as refusal:
                self.refused.append((each.name, refusal.reason))
        for place, each in enumerate(frozen):
            self.tell(StudyProgress(place, len(frozen), each.name, tuple(self.trials)))
            run = self.long_runs.of(each, frozen[place + 1 :])
            self.trials.append(trial_of(each, self.model, self.request.scenario, None, run))

    def _wanted(self, only: str | None) -> list[ControllerRequest]:
        """Return what is asked for, then designs and usual tunings; or one and its starts."""
        needed, wanted = {only}, list(self.request.controllers)
        if self.request.tries_every_design:
            named = {each.name for each in wanted}
            usual = usual_tunings(self.request.process, self.trials)
            for each in reversed(usual):  # one starts from another that stands before it
                needed |= {each.first} if each.name in needed else set()
            ours = [
                ControllerRequest(name, _made_by(each), None, each.asked)
                for name, each in studied_designs().items()
            ]
            ours += [ControllerRequest(each.name, each.make, each) for each in usual]
            wanted += [each for each in ours if each.name not in named]
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
            name = re.sub(r"[^A-Za-z0-9]+", "-", f"{self.case} {now.name}").strip("-").lower()
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
