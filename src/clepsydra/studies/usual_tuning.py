"""PI control tuned by simulation, where nobody says for what and within which limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.run import Run
from clepsydra.loop.running_scores import RunningScores
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.studies.ranking import QUIET, Trial, of_averaging
from clepsydra.studies.tuning.law_space import LawSpace
from clepsydra.studies.tuning.objective import Goal, Limits, Objective, minimax, weighted_sum
from clepsydra.studies.tuning.parameters import gains_and_times
from clepsydra.studies.tuning.result import TuningResult
from clepsydra.studies.tuning.tune import Search, tune

#: The design whose controller is tuned, and that of levels which average.
_START, _AVERAGING_START = "PI, SIMC", "PI, arrest time"
#: A tuned controller may have this many times the total variation of its start, or as much as
#: leaves this share of the noise movement of a quiet one: noise makes most of the moves.
_WEAR, _OF_QUIET = 2.0, 0.9
#: The global search simulates about so many samples of each candidate in all, but has at least so
#: many generations.
_SIMULATED, _FEWEST = 400_000, 8


class UsualTuning:
    """What a study tunes beside its designs: from one of them, with hardly more wear, as quiet.

    Parameters
    ----------
    trials : sequence of Trial
        Those of the study, among which it finds its start.
    """

    def __init__(self, process: Process, trials: Sequence[Trial]) -> None:
        self.process, self._trials = process, trials
        self.first = _AVERAGING_START if process.averaging else _START
        self.name = f"{self.first}, tuned"

    @property
    def _start(self) -> Trial:
        found = next((t for t in self._trials if t.controller.name == self.first), None)
        if found is None:
            raise NotApplicable(f"it starts from {self.first}, which does not apply")
        return found

    def make(self, analysis: Analysis, model: LinearModel) -> Controller:
        """Return the controller that it starts from.

        Raises
        ------
        NotApplicable
            The study has none.
        """
        return self._start.controller

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Tune the start for what ranks it; raises as `clepsydra.studies.tuning.tune.tune`."""
        most = min(search.generations, round(_SIMULATED / scenario.samples))
        objective, limits = self._goal(self._start)
        goal = Goal(model, scenario, objective, limits)
        space = LawSpace(controller, gains_and_times(controller))
        return tune(space, goal, replace(search, generations=max(_FEWEST, most)))

    def _goal(self, start: Trial) -> tuple[Objective, Limits]:
        noise = max(start.noise_movement, 1e-9)
        more = max(1.0, min(_WEAR, _OF_QUIET * QUIET / noise))
        wear = {
            name: more * start.scores[f"total_variation[{name}]"]
            for name in start.controller.manipulated
        }
        limits = Limits(SENSITIVITY_LIMIT, total_variation=wear)
        if not self.process.averaging:
            errors = [f"iae[{name}]" for name in dict.fromkeys(start.controller.setpoints)]
            return minimax(*errors), limits
        free = [name for name in self.process.averaging if name not in self.process.bands]
        limits = replace(limits, levels=_levels_used(start.run, free))
        return self._averaging_objective(start), limits

    def _averaging_objective(self, start: Trial) -> Objective:
        """Return the mean of what ranks a process whose levels average, relative to the start."""
        averaging = self.process.averaging
        names = [
            f"{score}[{name}]" for score, levels in of_averaging(self.process) for name in levels
        ]
        names += [f"iae[{name}]" for name in self.process.controlled if name not in averaging]
        names = [name for name in names if start.scores.get(name, 0.0) > 0.0]
        try:
            RunningScores(self.process, tuple(names)).inputs_of(start.run.scenario)
        except InputError as refusal:
            raise NotApplicable(
                f"what averaging is judged by is not known of {refusal.value}"
            ) from None
        if not names:
            raise NotApplicable(f"{', '.join(averaging)} leave nothing to lessen")
        return weighted_sum(dict.fromkeys(names, 1.0))


def _levels_used(run: Run, measurements: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the band around its first value that the level behind each measurement kept [m].

    The band reaches as far down as up: a run whose loads only filled a tank says as much about
    the room below.
    """
    process = run.process
    found = {}
    for name in measurements:
        state = process.measured_state.get(name)
        if state in process.levels:
            level, first = run.values[state], float(run.values[state][0])
            room = float(np.max(np.abs(level - first)))
            if room > 0.0:
                found[state] = (first - room, first + room)
    return found
