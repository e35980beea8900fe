"""How long a law has to follow its last output before it goes on from it without a bump."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.controllers.wiring import wired_setpoints
from clepsydra.program.delay_ring import DelayRing

#: A move of an output below this share of its range is none that an actuator could follow.
_NO_MOVE = 1e-5
#: By which share of their ranges the measurements have changed.
_CHANGE = 0.02
#: After so many scans a law goes on, settled or not.
MOST_SCANS = 20
#: Scans without sensors, and scans after which a law has settled.
_ABSENT, _SETTLED = 10, 100


def take_up_scans(controller: Controller, sampling_period: float, safe: Sequence[float]) -> int:
    """Return for how many scans a law follows its output before it is in force again.

    One is enough for what a law computes from the present measurements. A derivative, a filter,
    an observer or past measurements take longer to forget what has changed meanwhile. So the law
    is tried: without sensors its outputs are brought towards their fail-safe values, then the
    sensors are back, with other measurements and setpoints. After each scan of tracking the move
    is computed that automatic would make next, and that of the law when all has settled. The
    scans are counted until the two are within 1e-5 of the output's range, at most 20.

    Parameters
    ----------
    controller : Controller
        Without a shell.
    sampling_period : float
        [s]
    safe : sequence of float
        The fail-safe value of each output [unit].

    Examples
    --------
    >>> import clepsydra as cl
    >>> take_up_scans(cl.design.simc(cl.load("quadruple-tank")), 1.0, [0.0, 0.0])
    1
    """
    settled = _Followed(controller, sampling_period)
    settled.bring(safe)
    settled.change()
    settled.follow(_SETTLED)
    at_last = settled.moves()
    followed = _Followed(controller, sampling_period)
    followed.follow(_SETTLED)
    followed.bring(safe)
    followed.follow(_ABSENT, sensors=0.0)
    followed.change()
    for scans in range(1, MOST_SCANS):
        followed.follow()
        if not np.any(np.abs(followed.moves() - at_last) > _NO_MOVE):
            return scans
    return MOST_SCANS


class _Followed:
    """A law that follows its outputs, scan by scan."""

    def __init__(self, controller: Controller, period: float) -> None:
        self.controller, law = controller, controller.law
        self.law = law
        self.inputs = {signal.name: signal for signal in law.inputs}
        self.given = {name: _finite(signal.initial) for name, signal in self.inputs.items()}
        self.given |= controller.free_inputs | {"time_step": period}
        self.state = np.array([controller.initial_state[entry.name] for entry in law.state])
        self.rings = {
            place: deque([float(self.state[place])] * entry.length)
            for place, entry in enumerate(law.state)
            if isinstance(entry, DelayRing)
        }
        self.parameters = [controller.values[parameter.name] for parameter in law.parameters]
        self.outputs, self.measured = owners(law.outputs, "out"), owners(law.inputs, "pv")
        for y in self.measured:
            signal = self.inputs[path(y, "pv")]
            known = math.isfinite(signal.span)
            middle = 0.5 * (signal.low + signal.high) if known else self.given[signal.name]
            self.given |= {path(y, "good"): 1.0, path(y, "pv"): middle}
        self._set_setpoints()
        for u in self.outputs:
            start = controller.initial_state.get(path(u, "last_output"), 0.0)
            self.given |= {path(u, "tracking"): start, path(u, "mode"): float(Mode.TRACKING)}

    def _set_setpoints(self) -> None:
        controller = self.controller
        measured = dict(zip(controller.measurements, self.measured, strict=True))
        followed = wired_setpoints(controller.law, controller.free_inputs)
        for owner, name in zip(followed, controller.setpoints, strict=True):
            if name in measured:
                self.given[path(owner, "sp")] = self.given[path(measured[name], "pv")]

    def change(self) -> None:
        """Let every measurement change, and its setpoint with it."""
        for y in self.measured:
            span = self.inputs[path(y, "pv")].span
            self.given[path(y, "pv")] += _CHANGE * (span if math.isfinite(span) else 1.0)
        self._set_setpoints()

    def _step(self, inputs: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
        for place, ring in self.rings.items():
            self.state[place] = ring[0]
        following, outputs, _ = self.law.function(
            self.state, [inputs[name] for name in self.inputs], self.parameters
        )
        return np.array(following).ravel(), np.array(outputs).ravel()

    def bring(self, safe: Sequence[float]) -> None:
        """Let the outputs be brought half the way to their fail-safe values."""
        for u, value in zip(self.outputs, safe, strict=True):
            tracking = path(u, "tracking")
            self.given[tracking] = 0.5 * (self.given[tracking] + value)

    def follow(self, scans: int = 1, sensors: float = 1.0) -> None:
        """Run some scans in tracking."""
        good = {path(y, "good"): sensors for y in self.measured}
        for _ in range(scans):
            self.state, _ = self._step({**self.given, **good})
            for place, ring in self.rings.items():
                ring.popleft()
                ring.append(float(self.state[place]))

    def moves(self) -> np.ndarray:
        """Return by which share of its range each output would move in automatic now."""
        automatic = {path(u, "mode"): float(Mode.AUTOMATIC) for u in self.outputs}
        _, outputs = self._step({**self.given, **automatic})
        found = []
        for place, signal in enumerate(self.law.outputs):
            if signal.part == "out":
                span = signal.span if math.isfinite(signal.span) else 1.0
                found.append((outputs[place] - self.given[path(signal.owner, "tracking")]) / span)
        return np.array(found)


def _finite(value: float) -> float:
    return value if math.isfinite(value) else 0.0
