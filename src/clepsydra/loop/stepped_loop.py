"""A loop sample by sample: a law in Python, or a process that CVODES moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import controller_name
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.law_evaluation import LawEvaluation
from clepsydra.engine.stepping import SteppedKernel
from clepsydra.loop.begin import Begin
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.law_begin import loop_begin, process_rings
from clepsydra.loop.loop_state import LoopState, loop_state
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.loop.reference_motion import ReferenceMotion
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import Solver
from clepsydra.loop.stepped_alarms import SteppedAlarms
from clepsydra.loop.told_readings import ToldReadings
from clepsydra.loop.wired_loop import WiredLoop
from clepsydra.program.step_law import Equations, step_law


def stepped_loop(
    loop: WiredLoop, scenario: Scenario, substeps: int, solver: Solver = "kernel"
) -> tuple[dict[str, np.ndarray], LoopState]:
    """Simulate a loop sample by sample, with its law outside of the kernel.

    By the kernel the process is moved by the same statements as in the compiled loop, so a law
    that does the same arithmetic as expressions gives the same run, bit for bit.

    Parameters
    ----------
    loop : WiredLoop
    scenario : Scenario
    substeps : int
        RK4 steps in a sampling period.
    solver : {"kernel", "reference"}

    Returns
    -------
    dict, LoopState
        Name to trajectory [samples], what the compiled loop records; and where it stands at last.

    Raises
    ------
    InputError
        The law fails; the message names the sample and its time.
    """
    controller, law = loop.controller, loop.controller.law
    given, at_rest = loop.inputs_of(scenario), loop.at_rest()
    state, rings = loop_begin(loop, scenario, substeps)
    kind = _ReferencePlant if solver == "reference" else _KernelPlant
    plant = kind(loop, substeps, scenario.begin)
    evaluation = LawEvaluation(
        law,
        np.array([controller.values[parameter.name] for parameter in law.parameters]),
        np.array([state[controller_name(entry.name)] for entry in law.state]),
        {e.name: rings[name] for e in law.state if (name := controller_name(e.name)) in rings},
    )
    inner, alarms = inner_setpoints(controller, loop.process), SteppedAlarms(loop.process)
    rows: list[dict[str, float]] = []
    for k in range(scenario.samples):
        now = at_rest | {name: float(column[k]) for name, column in given.items()}
        now |= plant.look(now)
        now |= alarms.look(now)
        try:
            outputs = evaluation.step(loop.law_inputs(now))
        except InputError as error:
            place = f"{error.place}, sample {k} at {k * scenario.sampling_period:g} s"
            raise InputError(place, error.value, error.expected, error.remedy) from None
        now |= loop.told_by_law(outputs)
        after = dict(zip((x.name for x in law.state), evaluation.state, strict=True))
        now |= {each.name: float(after[each.state]) for each in inner}
        plant.advance(now)
        alarms.moved(now)
        rows.append(now)
    after = {
        controller_name(entry.name): value
        for entry, value in zip(law.state, evaluation.state.tolist(), strict=True)
    }
    held = {controller_name(name): ring for name, ring in evaluation.rings.items()}
    found, delays = plant.final()
    steps = 0 if solver == "reference" else substeps
    state = found | after
    final = loop_state(loop.process, controller, state, rows[-1], delays | held, steps)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, final


class _KernelPlant:
    """A process that a kernel moves, every input at its manual value."""

    def __init__(self, loop: WiredLoop, substeps: int, begin: Begin | None) -> None:
        # Alarms look at the loop, and no process on its own has one.
        process, at_rest = replace(loop.process, alarms=()), loop.at_rest()
        self._by_hand = {f"{u.name}.manual": u.name for u in process.inputs}
        self._outside = {d.name for d in process.disturbances}
        self._outside |= {f"{y.name}.noise" for y in process.measurements}
        constant = {
            name: value
            for name, value in at_rest.items()
            if name not in self._outside
            and name not in self._by_hand
            and not name.startswith("controller.")
        }
        self._moving = SteppedKernel(
            Kernel(
                closed_loop(process, NOBODY, substeps=substeps, constant=constant), fuse=loop.fuse
            ),
            inputs={name: at_rest[name] for name in self._by_hand},
            state=motion_at_rest(loop.point) if begin is None else begin.motion,
            rings={} if begin is None else process_rings(loop.process, begin, substeps),
        )

    def look(self, now: dict[str, float]) -> dict[str, float]:
        return self._moving.look({name: now[name] for name in self._outside})

    def advance(self, now: dict[str, float]) -> None:
        self._moving.step({manual: now[name] for manual, name in self._by_hand.items()})

    def final(self) -> tuple[dict[str, float], dict[str, np.ndarray]]:
        return self._moving.state, self._moving.rings


class _ReferencePlant:
    """A process that CVODES moves."""

    def __init__(self, loop: WiredLoop, substeps: int, begin: Begin | None) -> None:
        self._process = loop.process
        spilt = tuple(loop.process.spilt.values())
        start = None if begin is None else begin.motion
        held = None if begin is None else begin.rings
        self._motion = ReferenceMotion(loop.point, substeps, spilt, start=start, rings=held)
        at_first = loop.process.show(self._motion.state(), loop.process.parameter_values)
        self._sensors = ToldReadings(loop.process, np.array(at_first).ravel(), start, held)
        self._shown = np.zeros(0)

    def look(self, now: dict[str, float]) -> dict[str, float]:
        process, state = self._process, self._motion.state()
        found = {u.name: now[f"{u.name}.manual"] for u in process.inputs}
        found |= {x.name: float(v) for x, v in zip(process.state, state, strict=True)}
        found |= self._motion.recorded()
        true = np.array(process.measure(state, process.parameter_values)).ravel()
        noise = [now[f"{y.name}.noise"] for y in process.measurements]
        self._shown = np.array(process.display(true + noise)).ravel()
        told = self._sensors.told(self._shown)
        return found | {y.name: float(v) for y, v in zip(process.measurements, told, strict=True)}

    def advance(self, now: dict[str, float]) -> None:
        groups = (self._process.inputs, self._process.disturbances)
        self._motion.advance(*(np.array([now[s.name] for s in group]) for group in groups))
        self._sensors.advance(self._shown)

    def final(self) -> tuple[dict[str, float], dict[str, np.ndarray]]:
        motion, sensors = self._motion, self._sensors
        return motion.recorded() | sensors.state, motion.rings() | sensors.rings


#: Stands for no controller: every input of the process is at its manual value.
NOBODY = Controller(
    "nobody", "none", "", step_law(
        "nobody", inputs=[], parameters=[], state=[], outputs=[],
        equations=lambda symbols: Equations({}, {}),
    ),
    {}, {}, (), (), (),
)  # fmt: skip
