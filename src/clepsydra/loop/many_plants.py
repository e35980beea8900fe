"""Many plants of one kind where they begin: numbers of their own, at rest or away from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.wiring import controller_name
from clepsydra.engine.many_points import at_many_points
from clepsydra.linear.motions_at_rest import motions_at_rest
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.law_begin import inputs_in_mode
from clepsydra.loop.motion_block import RING_PARTS, ring_name
from clepsydra.loop.reported_readings import reporting_at
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.standing_in_manual import MOST_SAMPLES, followed
from clepsydra.loop.wired_loop import WiredLoop
from clepsydra.process.process import Process

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ManyPlants:
    """Plants that differ from one in their numbers, each where it begins, in SI.

    Parameters
    ----------
    point : OperatingPoint
        Of the one from which they differ.
    state : ndarray [n, plants]
        At rest.
    inputs : ndarray [m, plants]
        What stands there when the controller begins.
    values : mapping
        Parameter or disturbance to its value in each plant [plants]; others are those of the point.
    settings : mapping
        Parameter of the law to its value with each plant [plants]; others are the controller's.
    levels : mapping
        State of the process to what it begins at, where that is not at rest [plants].
    numbers : ndarray of int [plants], optional
        By which each has noise of its own, see `clepsydra.engine.white_noise.seed_of`; with none
        all have that of the scenario.
    """

    point: OperatingPoint
    state: Array
    inputs: Array
    values: Mapping[str, Array] = field(default_factory=dict)
    settings: Mapping[str, Array] = field(default_factory=dict)
    levels: Mapping[str, Array] = field(default_factory=dict)
    numbers: NDArray[np.int64] | None = None

    @property
    def process(self) -> Process:
        """The process from which they differ."""
        return self.point.process

    @property
    def count(self) -> int:
        """How many they are."""
        return self.state.shape[1]

    def chosen(self, which: NDArray[Any]) -> ManyPlants:
        """Return some of them, by their places or by a truth for each."""
        return ManyPlants(
            self.point, self.state[:, which], self.inputs[:, which],
            {name: column[which] for name, column in self.values.items()},
            {name: column[which] for name, column in self.settings.items()},
            {name: column[which] for name, column in self.levels.items()},
            None if self.numbers is None else self.numbers[which],
        )  # fmt: skip

    @property
    def parameters(self) -> dict[str, Array]:
        """Those parameters of the process that differ [plants]."""
        names = {signal.name for signal in self.process.parameters}
        return {name: column for name, column in self.values.items() if name in names}

    @property
    def disturbances(self) -> dict[str, Array]:
        """Those disturbances that differ [plants]."""
        names = {signal.name for signal in self.process.disturbances}
        return {name: column for name, column in self.values.items() if name in names}

    def begin(self, loop: WiredLoop, scenario: Scenario) -> dict[str, ArrayLike]:
        """Return the state of the closed loop by name, each [plants], its law without a bump.

        As `clepsydra.loop.law_begin.loop_begin` of one plant whose controller starts without a
        bump: the law has stood in manual at the first setpoints and what the sensors show, its
        outputs where the inputs stand.
        """
        process, motion = self.process, self.process.motion
        p, d = self._rows(process.parameters), self._rows(process.disturbances)
        contents, delayed, *_ = motions_at_rest(motion, self.state, self.inputs, d, p)
        state = self.state
        if self.levels:  # what is in a delay has run into it at rest
            rows = zip(process.state, self.state, strict=True)
            state = np.array([self.levels.get(signal.name, row) for signal, row in rows])
            contents = at_many_points(motion.to_contents, [state, p])
        shown = at_many_points(process.show, [state, p])
        readings = dict(zip((y.name for y in process.measurements), shown, strict=True))
        found: dict[str, ArrayLike] = {
            **{s.name: row for s, row in zip(motion.contents, contents, strict=True)},
            **{s.name: s.initial for s in motion.memories},
            **{
                ring_name(delay.name, part): row
                for delay, row in zip(motion.delays, delayed, strict=True)
                for part in RING_PARTS
            },
            **reporting_at(process, readings),
        }
        law = self._law(loop, scenario, readings)
        return found | {controller_name(name): row for name, row in law.items()}

    def _law(
        self, loop: WiredLoop, scenario: Scenario, readings: Mapping[str, Array]
    ) -> dict[str, Array]:
        now: dict[str, ArrayLike] = dict(loop.at_rest())
        now |= {n: float(column[0]) for n, column in loop.inputs_of(scenario).items()}
        now |= readings
        for u, row in zip(self.process.inputs, self.inputs, strict=True):
            now[u.name] = row
            if u.name in loop.controller.manipulated:
                now |= {f"{u.name}.manual": row, f"{u.name}.tracking": row}
        law = loop.controller.law
        inputs = inputs_in_mode(loop, now, Mode.MANUAL)
        settings = _table(law.parameters, {**loop.controller.values, **self.settings}, self.count)
        state = followed(loop.controller, inputs, settings, MOST_SAMPLES)
        return dict(zip((entry.name for entry in law.state), state, strict=True))

    def _rows(self, signals: Sequence[Signal]) -> Array:
        """Return the values of parameters or disturbances in each plant [signals, plants]."""
        own: dict[str, ArrayLike] = {s.name: s.initial for s in self.process.parameters}
        loads = zip(self.process.disturbances, self.point.disturbances.tolist(), strict=True)
        own |= {signal.name: value for signal, value in loads}
        return _table(signals, {**own, **self.values}, self.count)


def _table(signals: Sequence[Signal], values: Mapping[str, ArrayLike], count: int) -> Array:
    rows = [np.broadcast_to(values[signal.name], count) for signal in signals]
    return np.reshape(rows, (len(rows), count)).astype(float)
