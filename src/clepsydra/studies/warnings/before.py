"""What can be told of a loop before it is simulated."""

from __future__ import annotations

import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.remark import Remark
from clepsydra.controllers.controller import Controller
from clepsydra.linear.directions import blocking_zeros
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.scenario import Scenario
from clepsydra.studies.warnings.alarm_limits import alarm_limit_words
from clepsydra.studies.warnings.bandwidth import bandwidth_warnings
from clepsydra.studies.warnings.caveat import Caveat
from clepsydra.studies.warnings.forbidden_levels import level_words
from clepsydra.studies.warnings.loop_response import LoopResponse, loop_response
from clepsydra.studies.warnings.margins import margin_warnings
from clepsydra.studies.warnings.resting import resting_after, resting_saturation_words
from clepsydra.studies.warnings.sampling import sampling_warnings
from clepsydra.studies.warnings.stability import stability_warnings
from clepsydra.studies.warnings.unit_mix_up import unit_warnings
from clepsydra.studies.warnings.wind_up import wind_up_warnings

_NO_LOAD = Remark(
    "No load changes in the scenario, so that nothing says how well one is rejected",
    remedy="give a flow of the process a step, or the study a load",
)


def warnings_before(
    model: LinearModel,
    controller: Controller,
    scenario: Scenario,
    response: LoopResponse | None = None,
) -> tuple[Remark, ...]:
    """Return the warnings of a controller in a scenario, from linear models only.

    The most grave stand first: instability, units, what zeros and dead times forbid, margins,
    sampling, wind-up. A law that does not answer to small deviations, as a switch or a gap without
    gain, has no linear loop, so that stability to sampling are left out.

    The model has all measurements that the controller reads; the scenario begins at its operating
    point. The response is given where it is known already.

    Raises
    ------
    InputError
        The model has no operating point, or lacks a signal of the controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("quadruple-tank")
    >>> fast = cl.design.simc(plant).with_values({"level_1": {"K": 300.0}})
    >>> scenario = default_scenario(plant.linear)
    >>> print(warnings_before(plant.linear, fast, scenario)[0].partition(":")[0])
    The closed loop of level_1 and level_2 is unstable by its linear model
    """
    point = operating_point_of(model)
    words = []
    if response is None:
        try:
            response = loop_response(controller, model)
        except ClepsydraError as refusal:
            seen = "Stability, margins and bandwidth could not be checked"
            words.append(Remark(seen, str(refusal).removesuffix(".")))
    if response is not None and _answers(response):
        words += _of_the_loop(model, controller, response)
    words += wind_up_warnings(controller, point, response, scenario)
    return tuple(words)


def caveats_before(
    model: LinearModel, controller: Controller, scenario: Scenario
) -> tuple[Caveat, ...]:
    """Return what a scenario asks of a process in vain, and what it leaves open.

    That is levels that the plant forbids and manipulated variables without room to hold its steps,
    from a linear model; alarms that stand at rest, or come where a setpoint is; and that load
    rejection is not judged, where no load steps.

    Parameters
    ----------
    model : LinearModel
        Of the operating point where the scenario begins.
    controller : Controller
        Which levels have setpoints, and what is moved.
    """
    point, rests = operating_point_of(model), resting_after(controller, model, scenario)
    words = [
        *level_words(controller, point, scenario, rests),
        *resting_saturation_words(controller, point, rests),
        *alarm_limit_words(point, scenario),
    ]
    if not any(segment.kind == "load" for segment in scenario.segments):
        words.append(_NO_LOAD)
    return tuple(Caveat(each, each) for each in words)


def _answers(response: LoopResponse) -> bool:
    """Return whether the law answers to small deviations of a controlled measurement."""
    law = response.law
    return bool(response.outputs) and bool(np.any(law.B_measurement) or np.any(law.D_measurement))


def _of_the_loop(
    model: LinearModel, controller: Controller, response: LoopResponse
) -> list[Remark]:
    square = model.select(response.outputs, response.inputs)
    zeros = blocking_zeros(square)
    return [
        *stability_warnings(controller, model, response, [found.zero for found in zeros]),
        *unit_warnings(controller, model, response),
        *bandwidth_warnings(square, response, zeros),
        *margin_warnings(response),
        *sampling_warnings(controller, response),
    ]
