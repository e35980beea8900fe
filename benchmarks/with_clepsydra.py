"""The case in Clepsydra: the catalogue's process, the package's own PI law and closed loop."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.case import (
    FINAL,
    HIGH_LIMIT,
    LOW_LIMIT,
    NOMINAL,
    NOMINAL_VOLTAGE,
    RECORDED,
    Case,
    Solution,
)
from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.engine.kernel import Job, Kernel, Trajectories
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.loop.closed_loop import closed_loop, controller_name, loop_inputs
from clepsydra.loop.running_scores import RunningScores
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.program.program import Program
from clepsydra.scores.sample import Fold
from clepsydra.scores.score import SCORES, Score

#: The case's names and Clepsydra's, where they differ by more than the pattern below.
_PATTERNS = {
    "tank_area": "tank_{}.area",
    "outlet_area": "outlet_{}.area",
    "pump_gain": "pump_{}.gain",
    "split": "splitter_{0}.tank_{0}",
    "proportional_gain": "controller.level_{}.proportional_gain",
    "integral_time": "controller.level_{}.integral_time",
    "tracking_time": "controller.level_{}.tracking_time",
    "level": "tank_{}.level",
    "integral": "controller.level_{}.integral",
    "integral_absolute_error": "sum_of_absolute_errors[level_{}]",
    "pump": "pump_{}",
}


#: The case adds up the error at each sample, where IAE integrates from sample to sample.
ABSOLUTE_ERRORS = Score(
    "sum_of_absolute_errors",
    "Sum of absolute errors",
    "Sampling period times absolute error at each sample, added up.",
    powers=(1, 1),
    integrand=lambda sample: sample.period * abs(sample.error),
    fold=Fold.SUM,
)


def name_of(entry: str) -> str:
    """Return Clepsydra's name of a parameter or result of the case.

    Examples
    --------
    >>> name_of("tank_area_3"), name_of("split_1")
    ('tank_3.area', 'splitter_1.tank_1')
    """
    stem, number = entry.rsplit("_", 1)
    return _PATTERNS[stem].format(number)


def case_controller() -> Controller:
    """Return the two PI loops of the case."""
    levels, pumps = ("level_1", "level_2"), ("pump_1", "pump_2")
    law = multiloop_pid_law(levels, pumps)
    values = {signal.name: signal.initial for signal in law.parameters}
    for pump in pumps:
        values |= {path(pump, "low_limit"): LOW_LIMIT, path(pump, "high_limit"): HIGH_LIMIT}
    state = {path(pump, "last_output"): 0.0 for pump in pumps}
    state |= {path(level, "integral"): NOMINAL_VOLTAGE for level in levels}
    return Controller(
        name="PI",
        family="multiloop PI",
        design="Johansson's gains",
        law=law,
        values=values,
        initial_state=state,
        measurements=levels,
        setpoints=levels,
        manipulated=pumps,
    )


def _program(process: Process, controller: Controller) -> Program:
    # The case has neither noise nor load, sound sensors, and stays in automatic.
    setpoints = {f"{name}.setpoint" for name in process.controlled}
    constant = {s.name: s.initial for s in loop_inputs(process) if s.name not in setpoints}
    if ABSOLUTE_ERRORS.key not in SCORES:
        ABSOLUTE_ERRORS.registered()
    names = tuple(f"{ABSOLUTE_ERRORS.key}[{name}]" for name in process.controlled)
    scores = RunningScores(process, names)
    return closed_loop(process, controller, substeps=1, constant=constant, scores=scores)


@dataclass(frozen=True)
class Clepsydra:
    """The closed loop as a kernel.

    Parameters
    ----------
    kernel : Kernel
    controller : Controller
    """

    kernel: Kernel
    controller: Controller

    @classmethod
    def build(cls, cache: ObjectCache, *, record: bool, lanes: int | None = None) -> Clepsydra:
        """Read the process, write the program; machine code is made in the first run."""
        process, controller = load_process("quadruple-tank"), case_controller()
        kernel = Kernel(_program(process, controller), record=record, lanes=lanes, cache=cache)
        return cls(kernel, controller)

    def arguments(self, case: Case) -> dict[str, Any]:
        """Return the case as the arguments of `Kernel.prepare` and `Kernel.run`."""
        columns = {
            name_of(entry): row if case.scenarios > 1 else float(row[0])
            for entry, row in zip(NOMINAL, case.parameters, strict=True)
        }
        given = {controller_name(name): value for name, value in self.controller.values.items()}
        start = {
            controller_name(name): value for name, value in self.controller.initial_state.items()
        }
        levels = {name_of(f"level_{i + 1}"): float(h) for i, h in enumerate(case.initial_levels)}
        return {
            "samples": case.samples,
            "inputs": {f"level_{i + 1}.setpoint": case.setpoints[:, i] for i in (0, 1)},
            "parameters": {**given, **columns},
            "state": start | levels,
        }

    def prepare(self, case: Case) -> Job:
        """Lay out the case in memory."""
        return self.kernel.prepare(**self.arguments(case))


def solution(found: Trajectories) -> Solution:
    """Return what a kernel computed in the order of the case."""
    final = np.array([found.state(name_of(entry)) for entry in FINAL])
    if not found.record.size:
        return Solution(final)
    recorded = np.stack([found.output(name_of(entry))[0] for entry in RECORDED], axis=1)
    return Solution(final, recorded)


def first_call(case: Case, folder: Path, *, cached: bool) -> Callable[[], Trajectories]:
    """Return a call from process file to finished run, with or without a compiled object."""
    cache = ObjectCache(folder)

    def run() -> Trajectories:
        if not cached:
            shutil.rmtree(folder, ignore_errors=True)
        return Clepsydra.build(cache, record=case.scenarios == 1).prepare(case).run()

    return run
