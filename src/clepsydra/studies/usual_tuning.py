"""PI and PID control tuned by simulation, where nobody says for what and within which limits.

A study knows by it what it will tune before it loads what tunes, which comes after its first rows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.scores.effort import NOISE_MOVEMENT as MOVEMENT

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.analysis import Analysis
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.loop.scenario import Scenario
    from clepsydra.process.process import Process
    from clepsydra.studies.ranking import Trial
    from clepsydra.studies.tuning.result import TuningResult
    from clepsydra.studies.tuning.tune import Search

#: The design whose controller is tuned, and that of levels which average.
_START, _AVERAGING_START = "PI, SIMC", "PI, arrest time"
#: From this share of what noise may move an input by, nothing is left for a derivative.
_NOISY = 0.99
#: A derivative that leaves more than this share of the error is not worth its filter.
WORTH = 0.97
#: Generations of the search for a PID: its start is the best PI, near which the best PID lies.
_GENERATIONS = 1


class UsualTuning(ABC):
    """What a study tunes beside its designs: from one of its trials, for what ranks it.

    Parameters
    ----------
    name : str
        Of what it finds.
    first : str
        Of the controller that it starts from.
    trials : sequence of Trial
        Those of the study, among which it finds its start.
    """

    def __init__(self, name: str, first: str, trials: Sequence[Trial]) -> None:
        self.name, self.first, self._trials = name, first, trials

    @property
    def asked(self) -> object:
        """What tells it from any other that tunes the same controller."""
        return type(self), self.name, self.first

    @abstractmethod
    def make(self, analysis: Analysis, model: LinearModel) -> Controller:
        """Return the controller that it starts from.

        Raises
        ------
        NotApplicable
            The study has none.
        """

    @abstractmethod
    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        """Tune the start for what ranks it; raises as `clepsydra.studies.tuning.tune.tune`."""

    def _tried(self) -> Trial:
        """Return the trial that it starts from."""
        found = next((t for t in self._trials if t.controller.name == self.first), None)
        if found is None:
            raise NotApplicable(f"it starts from {self.first}, which does not apply")
        return found


class _TunedPi(UsualTuning):
    def make(self, analysis: Analysis, model: LinearModel) -> Controller:
        return self._tried().controller

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        from clepsydra.studies.tuning.law_space import LawSpace
        from clepsydra.studies.tuning.parameters import settings_of
        from clepsydra.studies.tuning.tune import tune
        from clepsydra.studies.usual_goal import usual_goal

        space = LawSpace(controller, settings_of(controller))
        return tune(space, usual_goal(controller, model, scenario), search)


class _TunedPid(UsualTuning):
    """The tuned PI with a derivative that is sought beside the other settings.

    Where noise moves every input as far as it may, a derivative only costs gain.
    """

    def make(self, analysis: Analysis, model: LinearModel) -> Controller:
        from clepsydra.studies.tuning.derivative_space import with_derivative
        from clepsydra.studies.usual_goal import NOISE_MOVEMENT

        tried = self._tried()
        moved = [u for u in tried.run.process.inputs if u.name in tried.controller.manipulated]
        shares = [tried.scores.get(f"{MOVEMENT.key}[{u.name}]", 0.0) / u.span for u in moved]
        if min(shares) > _NOISY * NOISE_MOVEMENT:
            raise NotApplicable(
                f"in {self.first} noise moves the inputs as far as it may, which leaves no room "
                "for a derivative"
            )
        return with_derivative(tried.controller, analysis)

    def run(
        self, controller: Controller, model: LinearModel, scenario: Scenario, search: Search
    ) -> TuningResult:
        from clepsydra.studies.tuning.derivative_space import DerivativeSpace
        from clepsydra.studies.tuning.tune import tune
        from clepsydra.studies.usual_goal import usual_goal

        goal = usual_goal(controller, model, scenario)
        search = replace(search, generations=_GENERATIONS, front=())
        found = tune(DerivativeSpace.around(controller, scenario.sampling_period), goal, search)
        names = goal.objective.names
        if share_left(found.scores, self._tried().scores, names) > WORTH:
            raise NotApplicable(
                f"a derivative takes less than {100 * (1 - WORTH):.0f} % off the errors of "
                f"{self.first}"
            )
        return found


def share_left(
    now: Mapping[str, float], before: Mapping[str, float], names: Iterable[str]
) -> float:
    """Return the mean share of scores that is left; of what was nothing there is no share.

    Examples
    --------
    >>> share_left({"a": 1.0, "b": 1e-18}, {"a": 2.0, "b": 0.0}, ["a", "b"])
    0.5
    """
    return float(np.mean([now[name] / before[name] for name in names if before[name] > 0.0]))


def usual_tunings(process: Process, trials: Sequence[Trial]) -> tuple[UsualTuning, ...]:
    """Return what a study of a process tunes, in the order in which one starts from the other.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> [each.name for each in usual_tunings(load_process("wet-well"), ())]
    ['PI, SIMC, tuned', 'PID, SIMC, tuned']
    >>> [each.name for each in usual_tunings(load_process("equalisation-tank"), ())]
    ['PI, arrest time, tuned']
    """
    if process.averaging:
        return (_TunedPi(f"{_AVERAGING_START}, tuned", _AVERAGING_START, trials),)
    pi = _TunedPi(f"{_START}, tuned", _START, trials)
    return pi, _TunedPid("PID, SIMC, tuned", pi.name, trials)
