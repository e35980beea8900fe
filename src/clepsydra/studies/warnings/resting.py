"""Where a scenario would bring a process to rest, by its linear model, and inputs without room."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.linear.dead_time import at_rest
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown, shown_apart
from clepsydra.loop.moves_at_rest import moves_at_rest
from clepsydra.loop.scenario import Scenario, Segment

#: An input that rests within this share of its range of a limit has no room, which the operating
#: point has a warning of.
_NO_ROOM = 0.02


@dataclass(frozen=True)
class Rest:
    """Inputs and states by which the setpoints are held after a step.

    Parameters
    ----------
    segment : Segment
        The step.
    values : dict
        Name of a state or manipulated variable to its value, SI.
    """

    segment: Segment
    values: dict[str, float]


def resting_after(controller: Controller, model: LinearModel, scenario: Scenario) -> list[Rest]:
    """Return where each setpoint and load step of a scenario comes to rest.

    0 = A Δx + B Δu + E Δd and Δr = C Δx + D Δu are solved together, so that a process that
    integrates needs no other route; of several solutions it is the smallest in shares of the
    ranges. As far as flows go with the root of a level it is an estimate.

    Parameters
    ----------
    model : LinearModel
        Of a process at the operating point where the scenario begins.

    Returns
    -------
    list of Rest
        Without the steps that the manipulated variables cannot hold at any value, and without
        loads that are over, as water poured in is, before they drive a level out of its range
        even if nothing is done against them: those need not be held.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> first = resting_after(controller, plant.linear, default_scenario(plant.linear))[0]
    >>> {name: round(value, 2) for name, value in first.values.items() if "pump" in name}
    {'pump_1': 3.54, 'pump_2': 2.73}
    """
    point = operating_point_of(model)
    process, at = point.process, point.as_dict()
    outputs = tuple(dict.fromkeys(controller.setpoints))
    resting = at_rest(model.select(outputs, controller.manipulated))
    places = [process.controlled.index(name) for name in outputs]
    start = np.array([at[name] for name in outputs])
    found = []
    for segment in scenario.segments:
        if segment.kind == "noise":
            continue
        sample = scenario.settled_sample_of(segment)
        loads = scenario.disturbances[sample] - point.disturbances
        if segment.kind == "load" and passes(resting, point, scenario, segment):
            continue
        wanted = np.concatenate([-resting.E @ loads, scenario.setpoints[sample, places] - start])
        moved = moves_at_rest(resting, wanted)
        if moved is not None:
            found.append(Rest(segment, {name: at[name] + move for name, move in moved.items()}))
    return found


def passes(model: LinearModel, point: OperatingPoint, scenario: Scenario, segment: Segment) -> bool:
    """Return whether a load ends before a state leaves its range without any control.

    Parameters
    ----------
    model : LinearModel
        Without dead time; see `at_rest`.
    """
    from scipy.linalg import expm

    place = model.disturbances.index(segment.signal)
    first = scenario.settled_sample_of(segment)
    loads = scenario.disturbances[first] - point.disturbances
    course = scenario.disturbances[first:, place]
    over = np.flatnonzero(course != course[0])
    if not over.size or course[over[0]] != point.disturbances[place]:
        return False
    # exp of the augmented matrix gives the integral of exp(A s) E d over its duration.
    states = len(model.states)
    augmented = np.zeros((states + 1, states + 1))
    augmented[:states] = np.column_stack([model.A, model.E @ loads])
    moved = expm(augmented * (over[0] * scenario.sampling_period))[:states, states]
    signals = [point.process.signal(name) for name in model.states]
    at = point.as_dict()
    return all(
        signal.low <= at[signal.name] + float(move) <= signal.high
        for signal, move in zip(signals, moved, strict=True)
    )


def resting_saturation_words(
    controller: Controller, point: OperatingPoint, rests: list[Rest]
) -> Iterator[Remark]:
    """Return in sentences which manipulated variables cannot hold a step, before simulating."""
    process, at = point.process, point.as_dict()
    for name in controller.manipulated:
        signal = process.signal(name)
        if not np.isfinite(signal.span):
            continue
        if abs(at[name] - _nearer_end(signal, at[name])) <= _NO_ROOM * signal.span:
            continue
        for rest in rests:
            value = rest.values[name]
            if not signal.low <= value <= signal.high:
                segment = rest.segment
                stepped = process.signal(segment.signal)
                asked, end = shown_apart(signal, value, _nearer_end(signal, value))
                yield Remark(
                    f"{name} saturates",
                    f"to hold the {segment.kind} step of {segment.signal} by "
                    f"{shown(stepped, segment.size)} it would have to rest at about "
                    f"{asked}, beyond {end}",
                    "make the step smaller, or give it another size",
                )
                break


def _nearer_end(signal: Signal, value: float) -> float:
    return signal.low if value - signal.low < signal.high - value else signal.high
