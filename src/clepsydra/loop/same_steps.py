"""The steps of a scenario from another rest: at another operating point, or of a variant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.signal_words import shown
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.with_noise import with_noise
from clepsydra.process.averaging import check_at_rest
from clepsydra.process.signal_values import beyond_range


def same_steps(scenario: Scenario, rest: OperatingPoint, point: OperatingPoint) -> Scenario:
    """Return a scenario that moves setpoints and disturbances by as much from another rest.

    Parameters
    ----------
    scenario : Scenario
        That begins at rest, with noise in its last stretch.
    rest, point : OperatingPoint
        Where it begins, and where the new one does.

    Raises
    ------
    InputError
        A level rests outside of its band there, a signal that steps is none of that process, or
        would leave its range.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("quadruple-tank")
    >>> lower = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    >>> found = same_steps(default_scenario(plant.linear), plant.point, lower.point)
    >>> found.setpoints[[0, 60], 0].round(6).tolist(), found.segments[0].size
    ([4.0, 5.0], 1.0)
    """
    process, at = point.process, point.as_dict()
    check_at_rest(process, at)
    loads = scenario.disturbances
    if scenario.quiet_disturbances is not None:
        loads = scenario.quiet_disturbances
    moved = dict(zip(rest.process.controlled, scenario.setpoints.T, strict=True))
    moved |= zip((signal.name for signal in rest.process.disturbances), loads.T, strict=True)
    before = rest.as_dict()
    courses = {name: column - before[name] for name, column in moved.items()}
    loads_here = [signal.name for signal in process.disturbances]
    for segment in scenario.segments:
        if segment.signal and segment.signal not in (*process.controlled, *loads_here):
            raise InputError(
                f"scenario, {segment.kind} step of {segment.signal}", segment.signal,
                f"a signal of {process.address}", "write [scenario] with steps that it has as well",
            )  # fmt: skip
        if segment.signal:
            _check_inside(point, segment.signal, segment.kind, courses[segment.signal])
    still = np.zeros(scenario.samples)
    setpoints, disturbances = (
        np.array([at[name] + courses.get(name, still) for name in names])
        .reshape(len(names), scenario.samples)
        .T
        for names in (process.controlled, loads_here)
    )
    quiet = replace(
        scenario,
        setpoints=setpoints,
        disturbances=disturbances,
        noise=np.zeros((scenario.samples, len(process.measurements))),
        noises=(),
        quiet_disturbances=None,
    )
    first = [scenario.sample_of(each) for each in scenario.segments if each.kind == "noise"]
    return with_noise(quiet, process, first[0]) if first else quiet


def _check_inside(point: OperatingPoint, name: str, kind: str, course: np.ndarray) -> None:
    """Refuse a course that takes a signal out of its range."""
    signal, rest = point.process.signal(name), point.as_dict()[name]
    what = "a setpoint" if kind == "setpoint" else "a load"
    for move in (float(np.min(course)), float(np.max(course))):
        if beyond := beyond_range(signal, rest + move, what):
            raise InputError(
                f"scenario, {kind} step of {name} by {shown(signal, move)}", *beyond,
                "write [scenario] with a smaller step, or one the other way",
            )  # fmt: skip
