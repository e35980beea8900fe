"""The check of a translation: the loop simulated with the block's form and printed numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.controllers import signals
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_form import Algorithm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.deploy.vendor_tuning.filling import Applied
from clepsydra.linear.linear_model import LinearModel
from clepsydra.loop.loop import Loop
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.program.step_law import StepLaw

#: Ratios of derivative to filter time that the isa and series algorithms hold.
_RATIOS = (1.0, 1000.0)


class Check:
    """Runs a controller as it is, and again with loops in the form of a vendor's block.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Of the process at the operating point where the controller rests.
    scenario : Scenario
    """

    def __init__(self, controller: Controller, model: LinearModel, scenario: Scenario) -> None:
        self.controller, self.model, self.scenario = controller, model, scenario
        self.original = Loop(controller, model).run(scenario)
        self._known: dict[tuple[tuple[str, Applied], ...], dict[str, float]] = {}

    def differences(self, applied: Mapping[str, Applied]) -> dict[str, float]:
        """Return the largest difference of each manipulated variable, as a share of its range.

        What a loop's block does is told by the loop's name; other loops stay as they are.
        """
        key = tuple(sorted(applied.items()))
        if key not in self._known:
            other = _in_form(self.controller, self.model, applied)
            run = Loop(other, self.model).run(self.scenario)
            self._known[key] = {name: self._largest(run, name) for name in other.manipulated}
        return self._known[key]

    def saturated(self) -> float:
        """Return the share of samples in which a manipulated variable is at a limit."""
        run, held = self.original, np.zeros(self.scenario.samples, bool)
        for name in self.controller.manipulated:
            low, high = run.limits(name)
            held |= (run.values[name] <= low) | (run.values[name] >= high)
        return float(np.mean(held))

    def _largest(self, run: Run, name: str) -> float:
        low, high = self.original.limits(name)
        span = self.original.process.signal(name).span
        width = span if math.isfinite(span) else high - low
        return float(np.max(np.abs(run.values[name] - self.original.values[name]))) / width


def _in_form(
    controller: Controller, model: LinearModel, applied: Mapping[str, Applied]
) -> Controller:
    """Return a controller with the forms and numbers of some of its PID loops replaced.

    Its anti-windup, limits, setpoint ramps and all other blocks stay.
    """
    law, values = controller.law, dict(controller.values)
    blocks = []
    for block in law.blocks:
        if isinstance(block, PidBlock) and block.owner in applied:
            found = applied[block.owner]
            algorithm = _algorithm(found, block.form.algorithm)
            form = replace(block.form, algorithm=algorithm, derivative_on=found.derivative_on)
            values |= {path(block.owner, k): v for k, v in _values(algorithm, found).items()}
            block = replace(block, form=form)
        blocks.append(block)
    changed = structure_law(
        law.name,
        blocks,
        setpoints=_of_inputs(law, "sp"),
        measured=[*_of_inputs(law, "pv").values()],
    )
    # A weight above 1 is none that a user should set, but some forms ask for it.
    weights = {path(loop, "setpoint_weight") for loop in applied}
    parameters = tuple(
        replace(each, low=-math.inf, high=math.inf) if each.name in weights else each
        for each in changed.parameters
    )
    changed = replace(changed, parameters=parameters)
    values = {each.name: values.get(each.name, each.initial) for each in parameters}
    loop = Loop(controller, model)
    at_rest = loop.at_rest() | loop.point.as_dict()
    wired = {name: at_rest[signal] for name, signal in controller.input_wires.items()}
    state = state_at_rest(changed, values, wired)
    return replace(controller, law=changed, values=values, initial_state=state)


def _algorithm(applied: Applied, own: Algorithm) -> Algorithm:
    """Return how the block is simulated: as it is, where the algorithm holds its filter.

    The velocity form is a controller's way not to wind up, which the check leaves as it is.
    """
    numbers = applied.settings
    if applied.form == "series":
        return "series"
    if own == "velocity":
        return "velocity"
    if not numbers.derivative_time:
        return applied.form
    held = numbers.filter_time and (
        _RATIOS[0] <= numbers.derivative_time / numbers.filter_time <= _RATIOS[1]
    )
    return applied.form if held else "parallel"


def _values(algorithm: Algorithm, applied: Applied) -> dict[str, float]:
    gain, integral_time, derivative_time, filter_time, weight = applied.settings
    # An infinite integral time is none: such a loop has no integral to be set.
    finite = min(integral_time, signals.LARGEST_PARAMETER)
    ratio = derivative_time / filter_time if filter_time else _RATIOS[1]
    values = {"proportional_gain": gain, "setpoint_weight": weight}
    if algorithm == "parallel":
        values |= {
            "integral_gain": gain / finite,
            "derivative_gain": gain * derivative_time,
            "filter_time": max(filter_time, signals.SHORTEST_TIME),
        }
    else:
        values |= {
            "integral_time": finite,
            "derivative_time": derivative_time,
            "derivative_filter": min(max(ratio, _RATIOS[0]), _RATIOS[1]),
        }
    return values


def _of_inputs(law: StepLaw, part: str) -> dict[str, Signal]:
    """Return the process signals of a law's inputs that are one part, by what these belong to."""
    return {
        signal.owner: replace(signal, name=signal.owner)
        for signal in law.inputs
        if signal.part == part
    }
