"""A controller at another operating point, or on another variant, with the settings it has."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.designs.applicability import NotApplicable
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.process.process import Process
from clepsydra.studies.tuning.resting_states import rested_elsewhere


def frozen_at(controller: Controller, own: LinearModel, model: LinearModel) -> Controller:
    """Return a controller with the settings it has, begun where another operating point rests.

    Its law begins as after a time in manual there, so that its outputs stand where the inputs
    rest: integrals take up what the point of the design differs by. Gains, models, and the points
    that deviations are taken from stay, and a law in Python begins as it says. An output goes no
    further than what it moves can.

    Parameters
    ----------
    own, model : LinearModel
        Of the process at the operating point where the controller rests, and at the other.

    Raises
    ------
    NotApplicable
        The process lacks a signal of the controller, or has it in another unit.

    Examples
    --------
    A pump that has to run at 2.48 V rather than at 3 V:

    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> lower = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    >>> frozen = frozen_at(cl.design.simc(plant), plant.measured, lower.measured)
    >>> round(frozen.initial_state["level_1.integral"], 2), frozen.values["level_1.integral_time"]
    (2.48, 32.032)
    """
    process = operating_point_of(model).process
    _check_signals(controller, operating_point_of(own).process, process)
    values = {**controller.values, **_limits(controller, process)}
    frozen = replace(controller, values=values)
    if isinstance(controller.law, PythonLaw):
        return frozen
    rest = rested_elsewhere(Loop(controller, own), Loop(frozen, model))
    return replace(frozen, initial_state=rest)


def _check_signals(controller: Controller, own: Process, there: Process) -> None:
    """Refuse a process whose signals are not those that the settings are for."""
    units = {each.name: each.unit for each in (*there.measurements, *there.inputs)}
    for name in (*controller.measurements, *controller.setpoints, *controller.manipulated):
        signal = own.signal(name)
        if units.get(name) != signal.unit:
            shown = f" in {signal.shown_unit}" if name in units else ""
            raise NotApplicable(f"{there.address} has no {name}{shown}, as its settings are for")


def _limits(controller: Controller, process: Process) -> dict[str, float]:
    """Return the limits of the outputs within the ranges of what they move."""
    found = {}
    for entry in controller.law.parameters:
        if entry.owner not in controller.manipulated:
            continue
        value, moved = controller.values[entry.name], process.signal(entry.owner)
        if entry.part == "low_limit":
            found[entry.name] = max(value, moved.low)
        elif entry.part == "high_limit":
            found[entry.name] = min(value, moved.high)
    return found
