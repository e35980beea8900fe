"""PI and PID control tuned by simulation, where nobody says for what and within which limits."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.studies.ranking import Trial
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.parameters import settings_of
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import Search, tune
from clepsydra.studies.usual_goal import usual_goal

#: The design whose controller is tuned, and that of levels which average.
_START, _AVERAGING_START = "PI, SIMC", "PI, arrest time"


class UsualTuning:
    """What a study tunes beside its designs: from one of them, for what ranks it.

    Parameters
    ----------
    trials : sequence of Trial
        Those of the study, among which it finds its start.
    """

    def __init__(self, process: Process, trials: Sequence[Trial]) -> None:
        self.process, self._trials = process, trials
        self.first = _AVERAGING_START if process.averaging else _START
        self.name = f"{self.first}, tuned"

    def make(self, analysis: Analysis, model: LinearModel) -> Controller:
        """Return the controller that it starts from.

        Raises
        ------
        NotApplicable
            The study has none.
        """
        found = next((t for t in self._trials if t.controller.name == self.first), None)
        if found is None:
            raise NotApplicable(f"it starts from {self.first}, which does not apply")
        return found.controller

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Tune the start for what ranks it; raises as `clepsydra.studies.tuning.tune.tune`."""
        space = LawSpace(controller, settings_of(controller))
        return tune(space, usual_goal(controller, model, scenario), search)
