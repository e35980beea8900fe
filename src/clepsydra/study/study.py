"""A study: every controller asked for, designed, tuned, simulated, scored and ranked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from clepsydra.controllers.controller import Controller
from clepsydra.design.applicability import NotApplicable
from clepsydra.linear.analysis import Analysis, analyse
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.loop.default_scenario import default_scenario
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.study.designs import DESIGNS
from clepsydra.study.file.request import StudyRequest
from clepsydra.study.ranking import QUIET, Trial, rank, verdict
from clepsydra.study.result import StudyResult
from clepsydra.study.trial import tried
from clepsydra.study.tuning.objective import Limits
from clepsydra.study.tuning.result import TuningResult
from clepsydra.study.tuning.tuned_pid import tuned_pid

#: The design whose controller a study tunes, and what the reader calls the result.
_START, _TUNED = "PI, SIMC", "PI, SIMC, tuned"
#: A tuned controller may have this many times the total variation of its start, or as much as
#: leaves this share of the noise movement of a quiet one: noise makes most of the moves.
_WEAR, _OF_QUIET = 2.0, 0.9
_LARGEST_PEAK = 2.0


class StudyProgress(NamedTuple):
    """How far a study has come.

    Parameters
    ----------
    done, of : int
        Controllers.
    name : str
        The one in work.

    Examples
    --------
    >>> StudyProgress(3, 15, "PI, SIMC").name
    'PI, SIMC'
    """

    done: int
    of: int
    name: str


def run_study(
    process: Process | StudyRequest | str | Path,
    *,
    seed: int = 1,
    progress: Callable[[StudyProgress], None] | None = None,
) -> StudyResult:
    """Design, tune, simulate, score and rank controllers of a process.

    Parameters
    ----------
    process : Process, StudyRequest, str or Path
        A process, a name of the catalogue or a process file: every design that applies is
        tried in the default scenario, and PI control is tuned by simulation. Or a study file,
        read by `study.file.reader.read_study`, which says what is tried.
    seed : int
        Of the measurement noise and the tuning; that of a study file stands in the file.
    progress : callable, optional
        Takes a `StudyProgress` before each controller.

    Returns
    -------
    StudyResult

    Raises
    ------
    NoEquilibrium
        The process has no operating point.
    InputError
        The process or study file cannot be used, or the process is sampled too slowly or too
        fast to be simulated.

    Examples
    --------
    >>> run_study("quadruple-tank").ranking[0].rank
    1
    """
    if isinstance(process, StudyRequest):
        return _Study.of_request(process, progress).result()
    if not isinstance(process, Process):
        process = load_process(process)
    analysis = analyse(process)
    substeps_for(analysis.model)  # a process that cannot be simulated is refused before all else
    scenario = default_scenario(analysis.model, seed=seed)
    return _Study(analysis, scenario, seed, progress).of_all_designs().result()


class _Study:
    def __init__(
        self,
        analysis: Analysis,
        scenario: Scenario,
        seed: int,
        progress: Callable[[StudyProgress], None] | None,
    ) -> None:
        self.analysis, self.scenario, self.seed = analysis, scenario, seed
        self.model: LinearModel = linearise(analysis.operating_point)
        self.tell = progress or (lambda _: None)
        self.trials: list[Trial] = []
        self.refused: list[tuple[str, str]] = []
        self.request: StudyRequest | None = None

    @classmethod
    def of_request(
        cls, request: StudyRequest, progress: Callable[[StudyProgress], None] | None
    ) -> _Study:
        study = cls(request.analysis, request.scenario, request.seed, progress)
        study.request = request
        if not request.controllers:
            return study.of_all_designs()
        for place, wanted in enumerate(request.controllers):
            study.tell(StudyProgress(place, len(request.controllers), wanted.name))
            with _Refusals(study, wanted.name):
                controller = wanted.make(study.analysis, study.model)
                tuning = None
                if wanted.tune is not None:
                    tuning = wanted.tune.run(
                        controller, study.model, study.scenario, seed=request.seed
                    )
                    controller = tuning.controller
                study.add(controller, tuning)
        return study

    def of_all_designs(self) -> _Study:
        for place, (name, design) in enumerate(DESIGNS.items()):
            self.tell(StudyProgress(place, len(DESIGNS) + 1, name))
            with _Refusals(self, name):
                self.add(design(self.analysis))
        self.tell(StudyProgress(len(DESIGNS), len(DESIGNS) + 1, _TUNED))
        with _Refusals(self, _TUNED):
            tuning = self._tuned()
            self.add(tuning.controller, tuning)
        return self

    def add(self, controller: Controller, tuning: TuningResult | None = None) -> None:
        self.trials.append(tried(controller, self.analysis, self.model, self.scenario, tuning))

    def _tuned(self) -> TuningResult:
        """Tune the gains and times of PI control, with hardly more wear, and as quiet."""
        averaging = self.analysis.operating_point.process.averaging
        if averaging:
            raise NotApplicable(
                _TUNED,
                f"it lessens the error of {', '.join(averaging)}, which is there to average; "
                "write a study file with a tuning for another aim",
            )
        start = next((t for t in self.trials if t.controller.name == _START), None)
        if start is None:
            raise NotApplicable(_TUNED, f"it starts from {_START}, which does not apply")
        noise = max(start.noise_movement, 1e-9)
        more = max(1.0, min(_WEAR, _OF_QUIET * QUIET / noise))
        wear = {
            name: more * start.scores[f"total_variation[{name}]"]
            for name in start.controller.manipulated
        }
        limits = Limits(_LARGEST_PEAK, total_variation=wear)
        return tuned_pid(start.controller, self.model, self.scenario, limits=limits, seed=self.seed)

    def result(self) -> StudyResult:
        process = self.analysis.operating_point.process
        ranking = rank(self.trials)
        return StudyResult(
            process=process,
            analysis=self.analysis,
            scenario=self.scenario,
            ranking=ranking,
            not_applicable=tuple(self.refused),
            verdict=verdict(process, ranking),
            warnings=self.analysis.operating_point.warnings,
        )


class _Refusals:
    """Keeps the reason of a controller that does not apply."""

    def __init__(self, study: _Study, name: str) -> None:
        self.study, self.name = study, name

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, NotApplicable):
            return False
        self.study.refused.append((self.name, error.reason))
        return True
