"""Warnings of integrals that wind up while their output stands at a limit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal, path
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.signals import owners
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.program.entries import signal_of
from clepsydra.program.step_law import StepLaw
from clepsydra.studies.warnings.loop_response import LoopResponse

#: What to do against wind-up.
ANTI_WINDUP = "choose conditional integration or back-calculation"
#: So many ranges away from its setpoint a measurement saturates every output.
_FAR = 1e3
#: An integral that moves less than this share of its first move stands still.
_STILL = 1e-9
#: A tracking time of so many integral times leaves the integral wound up for long.
_LONG = 3.0
#: What is asked for beyond a limit, as a share of the range, before it counts.
_BEYOND = 1e-3


def winds_up(controller: Controller, process: Process) -> tuple[str, ...]:
    """Return the outputs whose integral goes on for ever while the output stands at its limit.

    The step law itself runs for four samples with its measurements a thousand ranges away from
    their setpoints, and what its integrals gain in the third and in the fourth sample is
    compared. Under conditional integration and clamping that is nothing, and back-calculation
    makes it less from sample to sample. A law with a delay ring is not looked at.
    """
    found: set[str] = set()
    if not all(isinstance(entry, Signal) for entry in controller.law.state):
        return ()
    for direction in (-_FAR, _FAR):
        found |= _winding(controller, process, direction)
    return tuple(name for name in controller.manipulated if name in found)


def wind_up_warnings(
    controller: Controller,
    point: OperatingPoint,
    response: LoopResponse | None,
    scenario: Scenario,
) -> Iterator[Remark]:
    """Return warnings of wind-up, foreseen before simulating.

    *Nothing against it.* An integral without anti-windup (see `winds_up`), whose output the
    first sample after a setpoint step of the scenario drives into its limit.

    *Slow tracking.* Back-calculation whose tracking time is more than three integral times.

    Parameters
    ----------
    response : LoopResponse or None
        Where it is None, the first part is left out.

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, section 3.5.
    """
    yield from _without(controller, point, response, scenario)
    yield from _slow_tracking(controller)


def _winding(controller: Controller, process: Process, direction: float) -> set[str]:
    law = controller.law
    given = controller.free_inputs | {"time_step": process.sampling_period}
    at = {path(name, "setpoint"): _middle(process.signal(name)) for name in controller.setpoints}
    for signal in map(process.signal, controller.measurements):
        at[signal.name] = _middle(signal) + direction * _span(signal)
        at[path(signal, "sensor")] = 1.0
    for signal in map(process.signal, controller.manipulated):
        at |= {path(signal, what): _middle(signal) for what in ("manual", "tracking")}
        at[path(signal, "mode")] = float(Mode.AUTOMATIC)
    given |= {name: at[wire] for name, wire in controller.input_wires.items() if wire in at}
    inputs = [given.get(signal.name, signal.initial) for signal in law.inputs]
    parameters = [controller.values[parameter.name] for parameter in law.parameters]
    state = np.array([controller.initial_state[entry.name] for entry in law.state])
    rows = []
    for _ in range(4):
        following, outputs, _ = law.function(state, inputs, parameters)
        state = np.array(following).ravel()
        rows.append(state)
    ends = dict(zip([s.name for s in law.outputs], np.array(outputs).ravel(), strict=True))
    gains = np.diff(rows, axis=0)[1:]
    largest = np.max(np.abs(rows), axis=0)
    found, moved = set(), _moved(law)
    wired = dict(zip(owners(law.outputs, "out"), controller.manipulated, strict=True))
    for place, entry in enumerate(map(signal_of, law.state)):
        output = moved.get(entry.owner)
        if entry.part != "integral" or output not in wired:
            continue
        limits = (controller.values.get(path(output, f"{end}_limit")) for end in ("low", "high"))
        third, fourth = np.abs(gains[:, place])
        goes_on = third > _STILL * largest[place] and fourth >= third * (1.0 - _STILL)
        if goes_on and ends[path(output, "out")] in limits:
            found.add(wired[output])
    return found


def _moved(law: StepLaw) -> dict[str, str]:
    """Return the output that an integral moves, by what the integral belongs to."""
    outputs = owners(law.outputs, "out")
    # What has loops without blocks has one from each measurement to an output.
    found = dict(zip(owners(law.inputs, "pv"), outputs, strict=False)) if not law.blocks else {}
    loops = (block for block in law.blocks if isinstance(block, PidBlock))
    return found | {output: output for output in outputs} | {b.owner: b.moved.name for b in loops}


def _without(
    controller: Controller,
    point: OperatingPoint,
    response: LoopResponse | None,
    scenario: Scenario,
) -> Iterator[Remark]:
    if response is None:
        return
    process, at = point.process, point.as_dict()
    for name in winds_up(controller, process):
        row = controller.manipulated.index(name)
        signal = process.signal(name)
        for segment in scenario.segments:
            if segment.kind != "setpoint" or segment.signal not in controller.setpoints:
                continue
            column = controller.setpoints.index(segment.signal)
            kick = float(response.law.D_setpoint[row, column]) * segment.size
            asked = at[name] + kick
            beyond = max(asked - signal.high, signal.low - asked)
            if beyond > _BEYOND * _span(signal):
                yield Remark(
                    f"{name} winds up",
                    f"the setpoint step of {segment.signal} by "
                    f"{shown(process.signal(segment.signal), segment.size)} asks for "
                    f"{shown(signal, asked)}, beyond its range, and its integral has no "
                    "anti-windup, so that it overshoots for as long",
                    ANTI_WINDUP,
                )
                break


def _slow_tracking(controller: Controller) -> Iterator[Remark]:
    values, moved = controller.values, _moved(controller.law)
    for owner in owners(controller.law.parameters, "tracking_time"):
        tracking, integral = (
            values.get(path(owner, f"{what}_time")) for what in ("tracking", "integral")
        )
        if tracking is not None and integral is not None and tracking > _LONG * integral:
            yield Remark(
                f"{moved[owner]} comes out of saturation slowly",
                f"its tracking time of {time_text(tracking)} is {tracking / integral:.1f} "
                f"times its integral time of {time_text(integral)}",
                "make it at most as long",
            )


def _span(signal: Signal) -> float:
    return signal.span if np.isfinite(signal.span) else 1.0


def _middle(signal: Signal) -> float:
    return 0.5 * (signal.low + signal.high) if np.isfinite(signal.span) else signal.initial
