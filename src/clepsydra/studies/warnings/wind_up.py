"""Warnings of integrals that wind up while their output stands at a limit."""

from __future__ import annotations

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process
from clepsydra.studies.warnings.loop_response import LoopResponse
from clepsydra.studies.warnings.words import shown

#: So many ranges away from its setpoint a measurement saturates every output.
_FAR = 1e3
#: An integral that moves less than this share of its first move stands still.
_STILL = 1e-9
#: A tracking time of so many integral times leaves the integral wound up for long.
_LONG = 3.0
#: What is asked for beyond a limit, as a share of the range, before it counts.
_BEYOND = 1e-3


def winds_up(controller: Controller, process: Process) -> tuple[int, ...]:
    """Return the outputs whose integral goes on for ever while the output stands at its limit.

    Nothing is taken from names: the step law itself runs for four samples with its measurements
    a thousand ranges away from their setpoints, and what its states of the name "integral" gain
    in the third and in the fourth sample is compared. Under conditional integration and
    clamping that is nothing, and back-calculation makes it less from sample to sample.

    Parameters
    ----------
    controller : Controller
        A law with a delay ring is not looked at.
    process : Process

    Returns
    -------
    tuple of int
        i of manipulated_i.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> winds_up(controller, plant.process)
    ()
    """
    found: set[int] = set()
    if not all(isinstance(entry, Signal) for entry in controller.law.state):
        return ()
    for direction in (-_FAR, _FAR):
        found |= _winding(controller, process, direction)
    return tuple(sorted(found))


def wind_up_warnings(
    controller: Controller,
    point: OperatingPoint,
    response: LoopResponse | None,
    scenario: Scenario,
) -> list[str]:
    """Return warnings of wind-up, foreseen before simulating.

    *Nothing against it.* An integral without anti-windup (see `winds_up`), whose output the
    first sample after a setpoint step of the scenario drives into its limit.

    *Slow tracking.* Back-calculation whose tracking time is more than three integral times.

    Parameters
    ----------
    controller : Controller
    point : OperatingPoint
    response : LoopResponse or None
        Where it is None, the first part is left out.
    scenario : Scenario

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, section 3.5.

    Examples
    --------
    See `clepsydra.studies.warnings.before.warnings_before`.
    """
    return [
        *_without(controller, point, response, scenario),
        *_slow_tracking(controller),
    ]


def _winding(controller: Controller, process: Process, direction: float) -> set[int]:
    law = controller.law
    given = controller.free_inputs | {"time_step": process.sampling_period}
    for number, name in enumerate(controller.setpoints, start=1):
        given[f"setpoint_{number}"] = _middle(process.signal(name))
    for number, name in enumerate(controller.measurements, start=1):
        signal = process.signal(name)
        given[f"measurement_{number}"] = _middle(signal) + direction * _span(signal)
        given[f"sensor_{number}"] = 1.0
    for number, name in enumerate(controller.manipulated, start=1):
        middle = _middle(process.signal(name))
        given |= {f"mode_{number}": float(Mode.AUTOMATIC), f"manual_{number}": middle}
        given[f"tracking_{number}"] = middle
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
    found = set()
    for place, entry in enumerate(law.state):
        if not entry.name.startswith("integral_"):
            continue
        output = entry.name.rpartition("_")[2]
        limits = (controller.values.get(f"{end}_limit_{output}") for end in ("low", "high"))
        third, fourth = np.abs(gains[:, place])
        goes_on = third > _STILL * largest[place] and fourth >= third * (1.0 - _STILL)
        if goes_on and ends.get(f"manipulated_{output}", np.nan) in limits:
            found.add(int(output))
    return found


def _without(
    controller: Controller,
    point: OperatingPoint,
    response: LoopResponse | None,
    scenario: Scenario,
) -> list[str]:
    if response is None:
        return []
    process, at, words = point.process, point.as_dict(), []
    for number in winds_up(controller, process):
        name = controller.manipulated[number - 1]
        signal = process.signal(name)
        for segment in scenario.segments:
            if segment.kind != "setpoint" or segment.signal not in controller.setpoints:
                continue
            column = controller.setpoints.index(segment.signal)
            kick = float(response.law.D_setpoint[number - 1, column]) * segment.size
            asked = at[name] + kick
            beyond = max(asked - signal.high, signal.low - asked)
            if beyond > _BEYOND * _span(signal):
                words.append(
                    f"{name} winds up: the setpoint step of {segment.signal} by "
                    f"{shown(segment.size, process.signal(segment.signal))} asks for "
                    f"{shown(asked, signal)}, beyond its range, and its integral has no "
                    "anti-windup, so that it overshoots for as long; choose conditional "
                    "integration or back-calculation."
                )
                break
    return words


def _slow_tracking(controller: Controller) -> list[str]:
    values, words = controller.values, []
    for name, tracking in values.items():
        if not name.startswith("tracking_time_"):
            continue
        number = name.removeprefix("tracking_time_")
        integral = values.get(f"integral_time_{number}")
        if integral is not None and tracking > _LONG * integral:
            output = controller.manipulated[int(number) - 1]
            words.append(
                f"{output} comes out of saturation slowly: its tracking time of "
                f"{time_text(tracking)} is {tracking / integral:.1f} times its integral time of "
                f"{time_text(integral)}; make it at most as long."
            )
    return words


def _span(signal: Signal) -> float:
    return signal.span if np.isfinite(signal.span) else 1.0


def _middle(signal: Signal) -> float:
    return 0.5 * (signal.low + signal.high) if np.isfinite(signal.span) else signal.initial
