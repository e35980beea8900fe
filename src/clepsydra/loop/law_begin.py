"""With which states a controller begins away from rest."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.parameters import remembered_parameters, remembers
from clepsydra.controllers.wiring import controller_name
from clepsydra.loop.begin import Begin
from clepsydra.loop.delay_content import delay_content
from clepsydra.loop.motion_block import RING_PARTS, motion_at_rest, ring_name
from clepsydra.loop.open_loop_plan import emptied
from clepsydra.loop.reported_readings import reporting_state
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.standing_in_manual import MOST_SAMPLES, followed
from clepsydra.loop.wired_loop import WiredLoop
from clepsydra.process.process import Process
from clepsydra.program.entries import signal_of

Array = NDArray[np.float64]


def law_begin(loop: WiredLoop, scenario: Scenario) -> dict[str, float]:
    """Return the states of a law at the start of a scenario by name.

    At rest they are those that the controller was designed with. *Without a bump* they are those
    after the law stood in manual, with the first setpoints, what the sensors show at the start and
    its outputs where the inputs stand, until nothing moved any more: every law follows in manual
    what stands at its output. *Cold* they are what the law declares, and what remembers a parameter
    has its value.

    Examples
    --------
    PI control of an empty tank, 6.13 V below its setpoint, cold and without a bump: K is 3 V/V, so
    that the integral stands at 3 V - 18.4 V, and the pump at 3 V.

    >>> import clepsydra as cl
    >>> from clepsydra.loop.begin import begin_from
    >>> from clepsydra.loop.scenario import scenario_of_changes
    >>> plant = cl.load("quadruple-tank")
    >>> loop = WiredLoop(cl.design.simc(plant), plant.measured)
    >>> for way in ("cold", "bumpless"):
    ...     begin = begin_from(plant.point, "empty", controller_start=way)
    ...     run = scenario_of_changes(plant.point, [], 2, begin=begin)
    ...     print(round(law_begin(loop, run)["level_1.integral"], 3))
    0.0
    -15.394
    """
    controller, begin = loop.controller, scenario.begin
    if begin is None:
        return dict(controller.initial_state)
    kept = begin.kept
    if kept is not None and begin.goes_on(controller.initial_state):
        found = kept.of_law()
    elif begin.controller_start == "cold":
        found = cold_state(controller)
    else:
        parameters = [controller.values[entry.name] for entry in controller.law.parameters]
        now = now_at(loop, scenario, begin)
        followed = in_manual(loop, now, np.array(parameters), MOST_SAMPLES)
        found = dict(zip((e.name for e in controller.law.state), followed.tolist(), strict=True))
    return found | begin.law


def cold_state(controller: Controller) -> dict[str, float]:
    """Return the states that a law declares; what remembers a parameter has its value."""
    declared = {signal.name: signal.initial for signal in map(signal_of, controller.law.state)}
    return declared | remembered_parameters(controller.law, controller.values)


def empty_and_cold(loop: WiredLoop, said: Mapping[str, float]) -> dict[str, float]:
    """Return the state of a loop by name with empty tanks and a cold controller.

    Parameters
    ----------
    said : mapping
        States of the law that begin elsewhere [SI].
    """
    law = {**cold_state(loop.controller), **said}
    begun = {controller_name(name): value for name, value in law.items()}
    return motion_at_rest(emptied(loop.point)) | begun


def batch_begin(
    loop: WiredLoop, scenario: Scenario, begin: Begin, values: Mapping[str, Array]
) -> dict[str, ArrayLike]:
    """Return the same for several values of parameters: state to its value [candidates].

    Parameters
    ----------
    begin : Begin
        That of the scenario.
    values : mapping
        Parameter of the law to its value for each candidate [candidates]; the others keep the
        controller's.
    """
    law = loop.controller.law
    every: dict[str, ArrayLike] = {**loop.controller.values, **values}
    if begin.controller_start == "cold":
        remembered = {state: values[parameter] for state, parameter in remembers(law, values)}
        return {**law_begin(loop, scenario), **remembered, **begin.law}
    columns = np.broadcast_arrays(*(every[p.name] for p in law.parameters))
    parameters = np.reshape(columns, (len(law.parameters), -1))
    followed = in_manual(loop, now_at(loop, scenario, begin), parameters, MOST_SAMPLES)
    found = dict(zip((entry.name for entry in law.state), followed, strict=True))
    return {**found, **begin.law}


def now_at(loop: WiredLoop, scenario: Scenario, begin: Begin) -> dict[str, float]:
    """Return every signal of a loop at the start of a scenario by name, its law in manual."""
    process = loop.process
    now = loop.at_rest() | begin.inputs | begin.measurements(process)
    now |= {name: float(column[0]) for name, column in loop.inputs_of(scenario).items()}
    for name in loop.controller.manipulated:
        value = begin.inputs[name]
        now |= {f"{name}.manual": value, f"{name}.tracking": value}
    return now


def loop_begin(
    loop: WiredLoop, scenario: Scenario, substeps: int
) -> tuple[dict[str, float], dict[str, Array]]:
    """Return with what the kernel of a loop begins: its state by name, and its delay rings.

    Parameters
    ----------
    substeps : int
        Integration steps in a sampling period.
    """
    begin = scenario.begin
    if begin is None:
        return loop.initial_state(), {}
    law = law_begin(loop, scenario)
    numbers = {controller_name(name): value for name, value in law.items()}
    rings = process_rings(loop.process, begin, substeps)
    if begin.goes_on(law):
        own = {controller_name(name) for name in law}
        rings |= {name: ring for name, ring in begin.rings.items() if name in own}
    return begin.motion | numbers, rings


def process_rings(process: Process, begin: Begin, substeps: int) -> dict[str, Array]:
    """Return what the delays of a process hold in steps of a length, of those of which it is said.

    Parameters
    ----------
    substeps : int
        Integration steps in a sampling period.
    """
    found: dict[str, Array] = {}
    for delay in process.motion.delays:
        content = delay_content(delay.name, begin.rings)
        if content is not None:
            steps = round(delay.time / (process.sampling_period / substeps))
            parts = zip(RING_PARTS, content.over(steps), strict=True)
            found |= {ring_name(delay.name, part): ring for part, ring in parts}
    readings = {entry.name for entry in reporting_state(process)}
    return found | {name: ring for name, ring in begin.rings.items() if name in readings}


def in_manual(loop: WiredLoop, now: Mapping[str, float], parameters: Array, most: int) -> Array:
    """Return the states of a law after it stood in manual until nothing moved any more.

    Parameters
    ----------
    now : mapping
        Every signal of the loop by name; its modes do not count.
    parameters : ndarray [p] or [p, candidates]
        Of the law.
    most : int
        Samples, at most.

    Returns
    -------
    ndarray [n] or [n, candidates]
    """
    inputs = inputs_in_mode(loop, now, Mode.MANUAL)
    return followed(loop.controller, inputs, parameters, most)


def inputs_in_mode(loop: WiredLoop, now: Mapping[str, ArrayLike], mode: Mode) -> Array:
    """Return the inputs of a law with all its outputs in one mode, [m] or [m, cases]."""
    modes = {f"{name}.mode": float(mode) for name in loop.controller.manipulated}
    return loop.law_inputs({**now, **modes})
