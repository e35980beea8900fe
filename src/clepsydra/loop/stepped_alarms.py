"""Alarms in a loop that is simulated sample by sample."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.alarms.law import INTERLOCK
from clepsydra.controllers.blocks.status import Mode
from clepsydra.engine.law_evaluation import LawEvaluation
from clepsydra.loop.alarms import UNKNOWN, LoopAlarms
from clepsydra.process.alarm import interlocks
from clepsydra.process.process import Process


class SteppedAlarms:
    """The alarms of a process, evaluated by CasADi; none where it has none."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._alarms = LoopAlarms(process) if process.alarms else None
        if self._alarms:
            controller, law = self._alarms.controller, self._alarms.controller.law
            parameters = np.array([controller.values[each.name] for each in law.parameters])
            self._evaluation = LawEvaluation(law, parameters, np.zeros(len(law.state)))
            self._given = controller.free_inputs | dict.fromkeys(self._alarms.commands, UNKNOWN)

    def look(self, now: Mapping[str, float]) -> dict[str, float]:
        """Return what they tell in a sample, and what they change of the inputs that they hold."""
        if self._alarms is None:
            return {}
        controller = self._alarms.controller
        given = {name: now[wire] for name, wire in controller.input_wires.items() if wire in now}
        given |= {**self._given, "time_step": self._process.sampling_period}
        outputs = self._evaluation.step(np.array([given[s.name] for s in controller.law.inputs]))
        told = dict(zip((s.name for s in self._alarms.signals), outputs.tolist(), strict=True))
        for name, safe in interlocks(self._process.alarms).items():
            if told[path(name, INTERLOCK)]:
                held = (name, path(name, "manual"), path(name, "tracking"))
                told |= dict.fromkeys(held, safe) | {path(name, "mode"): float(Mode.TRACKING)}
        return told

    def moved(self, now: Mapping[str, float]) -> None:
        """Remember where the inputs that they watch have been moved to."""
        if self._alarms is not None:
            self._given |= {name: now[u] for name, u in self._alarms.commands.items()}
