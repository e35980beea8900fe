"""An experiment of a document, in which its controllers, ours and the best input compete."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.limits.event import Event, rest_at
from clepsydra.limits.limit import Limit, limit_of
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.begin import begin_from
from clepsydra.loop.open_loop_plan import emptied
from clepsydra.loop.profile import Change
from clepsydra.loop.scenario import Scenario, scenario_of_changes
from clepsydra.process.process import Process
from clepsydra.scores.segment import Segment

#: What makes each experiment of a document, by its title.
Contests = Mapping[str, "Callable[[], Contest]"]


@dataclass(frozen=True, eq=False)
class Contest:
    """One experiment: setpoints that step from rest, all at once, without noise.

    Parameters
    ----------
    analysis : Analysis
        Of the plant at rest, where controllers are designed.
    targets : mapping
        Each controlled measurement to its setpoint [SI].
    duration : float
        From the steps to the end [s].
    published : mapping
        Name, as a table has it, to each of the document's controllers.
    empty : bool
        Whether it begins with empty tanks and inputs at zero, and not where the plant rests.
    """

    analysis: Analysis
    targets: Mapping[str, float]
    duration: float
    published: Mapping[str, Controller]
    empty: bool = False

    @property
    def point(self) -> OperatingPoint:
        """Where controllers are designed."""
        return self.analysis.operating_point

    @property
    def process(self) -> Process:
        """The plant."""
        return self.point.process

    @cached_property
    def model(self) -> LinearModel:
        """Its linear model with all measurements."""
        return linearise(self.point)

    @property
    def start(self) -> OperatingPoint:
        """Where it begins."""
        return emptied(self.point) if self.empty else self.point

    @property
    def sizes(self) -> dict[str, float]:
        """Each controlled measurement to its step [SI]."""
        at = self.start.as_dict()
        return {name: self.targets[name] - at[name] for name in self.process.controlled}

    @cached_property
    def scenario(self) -> Scenario:
        """A sample at rest, and then the steps."""
        period = self.process.sampling_period
        samples = round(self.duration / period) + 1
        at, end = self.start.as_dict(), samples * period
        changes = [
            change
            for name, target in self.targets.items()
            for change in (Change(name, at[name], 0.0, 0.0), Change(name, target, period, period))
        ]
        segments = [
            Segment("setpoint", name, period, end, size) for name, size in self.sizes.items()
        ]
        standing = {signal.name: 0.0 for signal in self.process.inputs}
        begin = begin_from(self.point, "empty", given=standing) if self.empty else None
        return scenario_of_changes(self.point, changes, samples, tuple(segments), begin=begin)

    @cached_property
    def event(self) -> Event:
        """What is asked of the best input: all steps at once."""
        scenario = self.scenario
        return Event(
            segment=scenario.segments[0],
            outputs=self.process.controlled,
            steps=np.abs(list(self.sizes.values())),
            start=self.start,
            target=rest_at(self.point, self.targets, self.point.disturbances),
            setpoints=scenario.setpoints[1:],
            disturbances=scenario.disturbances[1:],
        )

    def limit(self) -> Limit:
        """Return the least error that any input could leave, each output's over its step.

        Raises
        ------
        NoCourse
            None was found.
        """
        return limit_of(self.event, self.model)
