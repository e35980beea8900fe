"""Where a closed loop begins, if not at rest at its operating point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.words import listed
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.loop_state import LoopState
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.loop.open_loop_plan import Start, emptied
from clepsydra.loop.reported_readings import held_names, reporting_at, told_at
from clepsydra.process.process import Process

#: How a controller begins: its states solved so that its outputs stand where the inputs do, or as
#: its law declares them.
ControllerStart = Literal["bumpless", "cold"]


@dataclass(frozen=True, eq=False)
class Begin:
    """Where a closed loop begins.

    Parameters
    ----------
    words : str
        "empty".
    state : dict
        State of the process to its value [SI].
    inputs : dict
        Input to what stands there when the controller begins [SI].
    motion : dict
        What lives from sample to sample of the process; a delay to the one value that it holds.
    rings : dict
        Delay to what it holds, where that differs along it, the oldest first [length].
    controller_start : {"bumpless", "cold"}
    kept : LoopState or None
        From which a controller of the same law goes on as it was.
    law : dict
        States of the law that begin elsewhere [SI].
    substeps : int
        Integration steps in a sampling period that a run takes at least.
    """

    words: str
    state: dict[str, float]
    inputs: dict[str, float]
    motion: dict[str, float]
    rings: dict[str, np.ndarray] = field(default_factory=dict)
    controller_start: ControllerStart = "bumpless"
    kept: LoopState | None = None
    law: dict[str, float] = field(default_factory=dict)
    substeps: int = 1

    def measurements(self, process: Process) -> dict[str, float]:
        """Return what the sensors tell there, without noise [SI]."""
        oldest = {name: float(ring[0]) for name, ring in self.rings.items()}
        return told_at(process, _shown(process, self.state), {**self.motion, **oldest})

    def as_dict(self) -> dict[str, Any]:
        """Return all that a run begins with as values for JSON, in SI."""
        return {
            "begins": self.words,
            "state": self.motion,
            "inputs": self.inputs,
            "delays": {name: ring.tolist() for name, ring in self.rings.items()},
            "controller_start": self.controller_start,
            "controller": self.law if self.kept is None else {**self.kept.of_law(), **self.law},
        }

    def goes_on(self, law: Mapping[str, object]) -> bool:
        """Tell whether a law of these states goes on where another run left it."""
        return self.kept is not None and self.kept.of_law().keys() == law.keys()

    def way_of(self, law: Mapping[str, object], *, bump: bool) -> str:
        """Return how a law of these states starts, in words, and whether its outputs move."""
        if self.goes_on(law):
            return "as it was"
        if self.controller_start == "cold":
            return "cold"
        return "as from manual, which moves its outputs" if bump else "without a bump"


def begin_from(
    rest: OperatingPoint,
    start: Start | OperatingPoint | LoopState = "rest",
    *,
    given: Mapping[str, float] | None = None,
    law: Mapping[str, float] | None = None,
    controller_start: ControllerStart | None = None,
) -> Begin | None:
    """Return where a closed loop begins; None at rest, with its controller as it rests.

    What is in a delay has run into it for ever at the point where it begins; after another run it
    is what was in it.

    Parameters
    ----------
    rest : OperatingPoint
        Of the process.
    start : {"rest", "empty"}, OperatingPoint or LoopState
        At rest, with empty tanks, at another point, or where another run ended.
    given : mapping, optional
        States and inputs of the process that stand elsewhere [SI].
    law : mapping, optional
        States of the law that begin elsewhere [SI].
    controller_start : {"bumpless", "cold"}, optional
        If left out bumpless, or after a run of a controller of the same law as it was.

    Raises
    ------
    InputError
        The point or the state is one of another process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> point = cl.load("quadruple-tank").point
    >>> begin = begin_from(point, "empty", given={"tank_1.level": 0.02})
    >>> round(begin.measurements(point.process)["level_1"], 9), begin.words  # [V], at 50 V/m
    (1.0, 'empty, but for tank_1.level')
    """
    process, given, law = rest.process, given or {}, law or {}
    if start == "rest" and not given and not law and controller_start is None:
        return None
    said = [*given, *law]
    but = f", but for {listed(said)}" if said else ""
    way: ControllerStart = controller_start or "bumpless"
    if isinstance(start, LoopState):
        _check(process, [s.name for s in start.signals], start.process, start.contents)
        words = f"where a run of {start.process} ended"
        state, inputs = (
            {signal.name: start[signal.name] for signal in group}
            for group in (process.state, process.inputs)
        )
        kept = start if controller_start is None else None
        moving = dict(start.contents), dict(start.rings)
        begin = Begin(words + but, state, inputs, *moving, way, kept, dict(law), start.substeps)
    else:
        point, words = rest, "at rest"
        if isinstance(start, OperatingPoint):
            point, words = start, "at another operating point"
            check_point(process, start)
        elif start == "empty":
            point, words = emptied(rest), "empty"
        at = point.as_dict()
        state, inputs = (
            {signal.name: at[signal.name] for signal in group}
            for group in (process.state, process.inputs)
        )
        begin = Begin(words + but, state, inputs, motion_at_rest(point), {}, way, None, dict(law))
    return _moved(begin, process, given, goes_on=isinstance(start, LoopState))


def _moved(begin: Begin, process: Process, given: Mapping[str, float], *, goes_on: bool) -> Begin:
    """Return a begin with some states and inputs of the process elsewhere."""
    for part in (begin.state, begin.inputs):
        part |= {name: value for name, value in given.items() if name in part}
    if any(signal.name in given for signal in process.state):
        state = np.array([begin.state[signal.name] for signal in process.state])
        contents = np.array(process.motion.to_contents(state, process.parameter_values)).ravel()
        for signal, value in zip(process.motion.contents, contents, strict=True):
            begin.motion[signal.name] = float(value)
        if not goes_on:  # else sensors still have to tell what they read before
            begin.motion.update(reporting_at(process, _shown(process, begin.state)))
    return begin


def _shown(process: Process, at: Mapping[str, float]) -> dict[str, float]:
    """Return what the sensors show of a state, without noise [SI]."""
    state = np.array([at[signal.name] for signal in process.state])
    shown = np.array(process.show(state, process.parameter_values)).ravel()
    return {y.name: float(v) for y, v in zip(process.measurements, shown, strict=True)}


def check_point(process: Process, point: OperatingPoint) -> None:
    """Refuse to begin at a point of another process."""
    _check(process, [*point.as_dict()], point.process.name, motion_at_rest(point))


def _check(process: Process, signals: list[str], name: str, motion: Mapping[str, float]) -> None:
    """Refuse a start on another process, which has other states, inputs or contents."""
    wanted = [s.name for s in (*process.state, *process.inputs)]
    lived = [s.name for s in (*process.motion.contents, *process.motion.memories)]
    lived += held_names(process)
    if not set(wanted) <= set(signals) or not set(lived) <= set(motion):
        missing = next((n for n in wanted if n not in signals), f"the contents of {process.name}")
        raise InputError(
            "start", f"one of {name}", f"one of {process.name}; it has no {missing}",
            "begin with a run of this plant, or at an operating point of it",
        )  # fmt: skip
