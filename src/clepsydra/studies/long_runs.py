"""Long runs of a study's controllers, those of one law side by side."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from clepsydra.base.errors import ClepsydraError
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.run_cost import run_cost
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.several_loops import TOGETHER, checked_runs, run_alike
from clepsydra.studies.trial import REFINEMENT

#: From which length on a checked run is worth waiting for the next designs [s], and up to how many
#: samples the trajectories of all find room in memory.
LONG, MOST_SAMPLES = 0.3, 50_000


class LongRuns:
    """The runs of a study, of which those of controllers that come next may be known.

    Parameters
    ----------
    model : LinearModel
        Of the operating point where the scenario begins.

    Examples
    --------
    The runs of a rig of four tanks are short:

    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("quadruple-tank")
    >>> runs = LongRuns(plant.measured, default_scenario(plant.measured))
    >>> runs.of(cl.design.simc(plant), [cl.design.amigo(plant)]) is None
    True
    """

    def __init__(self, model: LinearModel, scenario: Scenario) -> None:
        self.model, self.scenario = model, scenario
        self._made: list[tuple[Controller, Run]] = []

    def of(self, controller: Controller, later: Iterable[Controller]) -> Run | None:
        """Return the checked run of a controller, made beside those of some that come later.

        None where it is short, or the next of them is of another law.

        Parameters
        ----------
        later : iterable of Controller
            It is asked for no more than have room, as long as they are of the same law.
        """
        for place, (each, run) in enumerate(self._made):
            if each is controller:
                del self._made[place]
                return run
        if not controller.setpoints:
            return None
        first = Loop(controller, self.model)
        if not self._is_long(first):
            return None
        group = [first]
        with suppress(ClepsydraError):  # a mistake is told when its own turn comes
            for other in later:
                loop = Loop(other, self.model)
                if not (other.setpoints and run_alike(first, loop, self.scenario)):
                    break
                group.append(loop)
                if len(group) == TOGETHER:
                    break
        if len(group) == 1:
            return None
        found, *rest = checked_runs(group, self.scenario, REFINEMENT)
        self._made += zip((loop.controller for loop in group[1:]), rest, strict=True)
        return found

    def _is_long(self, loop: Loop) -> bool:
        samples, substeps = self.scenario.samples, loop.first_count(self.scenario)
        cost = run_cost(loop.process, samples, substeps, checked=True)
        return cost >= LONG and samples <= MOST_SAMPLES
