"""How long a law has to follow its last output before it goes on from it without a bump."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers.at_rest import scanned
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.controllers.wiring import wired_setpoints

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

    `controller`: without a shell; `sampling_period` [s]; `safe`: the fail-safe value of each output
    [unit].

    Examples
    --------
    >>> import clepsydra as cl
    >>> take_up_scans(cl.design.simc(cl.load("quadruple-tank")), 1.0, [0.0, 0.0])
    1
    """
    law, inputs = controller.law, {signal.name: signal for signal in controller.law.inputs}
    outputs, measured = owners(law.outputs, "out"), owners(law.inputs, "pv")
    rest = {name: s.initial if math.isfinite(s.initial) else 0.0 for name, s in inputs.items()}
    rest |= controller.free_inputs | {"time_step": sampling_period}
    change = {}
    for y in measured:
        pv = inputs[path(y, "pv")]
        if math.isfinite(pv.span):
            rest[pv.name] = 0.5 * (pv.low + pv.high)
        change[pv.name] = rest[pv.name] + _CHANGE * _span(pv)
    for u in outputs:
        rest[path(u, "tracking")] = controller.initial_state.get(path(u, "last_output"), 0.0)
        rest[path(u, "mode")] = float(Mode.TRACKING)
    names = dict(zip(controller.measurements, measured, strict=True))
    free = wired_setpoints(law, controller.free_inputs)
    follow = {
        path(owner, "sp"): path(names[name], "pv")
        for owner, name in zip(free, controller.setpoints, strict=True)
        if name in names
    }

    def now(given: dict[str, float], sensors: float = 1.0) -> dict[str, float]:
        setpoints = {sp: given[pv] for sp, pv in follow.items()}
        return given | setpoints | {path(y, "good"): sensors for y in measured}

    tracked = [path(u, "tracking") for u in outputs]
    half = {name: 0.5 * (rest[name] + value) for name, value in zip(tracked, safe, strict=True)}
    moved = now(rest | half | change)
    automatic = moved | {path(u, "mode"): float(Mode.AUTOMATIC) for u in outputs}

    def moves(*scans: dict[str, float]) -> np.ndarray:
        """Return by which share of its range each output would move in automatic after these."""
        values, state = controller.values, controller.initial_state
        _, result = scanned(law, values, state, *scans, automatic)
        ends = (s for s in law.outputs if s.part == "out")
        return np.array(
            [(result[s.name] - moved[path(s.owner, "tracking")]) / _span(s) for s in ends]
        )

    at_last = moves(*[moved] * _SETTLED)
    before = [now(rest)] * _SETTLED + [now(rest | half, sensors=0.0)] * _ABSENT
    for scans in range(1, MOST_SCANS):
        if not np.any(np.abs(moves(*before, *[moved] * scans) - at_last) > _NO_MOVE):
            return scans
    return MOST_SCANS


def _span(signal: Signal) -> float:
    return signal.span if math.isfinite(signal.span) else 1.0
