"""Parameters and states of LQI laws whose state comes from the equations of the process."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.observers.measured_state import ProcessState
from clepsydra.controllers.process_equations import ProcessEquations, models_in
from clepsydra.designs.states.linear_quadratic import LqiGains
from clepsydra.designs.states.state_controllers import (
    matrix_values,
    parts_values,
    rest_values,
)


def constant_values(source: ProcessState) -> dict[str, float]:
    """Return the values of model.* that a source of the state computes with.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.observers.measured_state import MeasuredState
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> model = cl.load("quadruple-tank").linear
    >>> len(constant_values(MeasuredState(process_equations(model))))
    4
    """
    return {each.name: each.initial for each in models_in(source.equations, source.expressions)}


def gain_values(equations: ProcessEquations, gains: LqiGains) -> dict[str, float]:
    """Return feedback and integral_gain of the outputs.

    Examples
    --------
    >>> import numpy as np
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("three-tanks").linear)
    >>> gains = LqiGains(np.array([[3.0, 2.0, 1.0]]), np.array([[0.5]]), np.array([0.5]))
    >>> gain_values(equations, gains)["feed.integral_gain.level_3"]
    0.5
    """
    inputs = equations.inputs
    return {
        **matrix_values("feedback", inputs, equations.states, gains.feedback),
        **matrix_values("integral_gain", inputs, equations.outputs, gains.integral),
    }


def output_values(
    equations: ProcessEquations, tracking_times: Sequence[float], anti_windup: AntiWindup
) -> dict[str, float]:
    """Return references of the states, biases, limits and tracking times.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> output_values(equations, [30.0, 30.0], "none")["pump_1.bias"]
    3.0
    """
    at, states, inputs = equations.point.as_dict(), equations.states, equations.inputs
    values = parts_values("reference", states, [at[name] for name in states])
    values |= rest_values(equations.point, inputs)
    if anti_windup == "back_calculation":
        values |= parts_values("tracking_time", inputs, tracking_times)
    return values
