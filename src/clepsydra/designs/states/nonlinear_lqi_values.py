"""Parameters and states of LQI laws whose state comes from the equations of the process."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.controllers.blocks.anti_windup import AntiWindup
from clepsydra.controllers.observers.measured_state import StateSource
from clepsydra.controllers.process_equations import ProcessEquations, model_parameter
from clepsydra.designs.states.linear_quadratic import LqiGains


def constant_values(source: StateSource) -> dict[str, float]:
    """Return the values of model_* that a source of the state computes with.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.observers.measured_state import MeasuredState
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> model = cl.load("quadruple-tank").linear
    >>> len(constant_values(MeasuredState(process_equations(model))))
    4
    """
    return {model_parameter(each).name: each.value for each in source.constants}


def gain_values(gains: LqiGains) -> dict[str, float]:
    """Return feedback_i_j and integral_gain_i_j.

    Examples
    --------
    >>> import numpy as np
    >>> gain_values(LqiGains(np.array([[2.0]]), np.array([[0.5]]), np.array([0.5])))
    {'feedback_1_1': 2.0, 'integral_gain_1_1': 0.5}
    """
    return {
        f"{what}_{i}_{j}": float(value)
        for what, rows in (("feedback", gains.feedback), ("integral_gain", gains.integral))
        for i, row in enumerate(rows, start=1)
        for j, value in enumerate(row, start=1)
    }


def output_values(
    equations: ProcessEquations, tracking_times: Sequence[float], anti_windup: AntiWindup
) -> dict[str, float]:
    """Return reference_state_j, bias_i, limits and tracking times.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> equations = process_equations(cl.load("quadruple-tank").linear)
    >>> output_values(equations, [30.0, 30.0], "none")["bias_1"]
    3.0
    """
    process, at = equations.point.process, equations.point.as_dict()
    values = {f"reference_state_{j}": at[name] for j, name in enumerate(equations.states, 1)}
    for i, name in enumerate(equations.inputs, start=1):
        signal = process.signal(name)
        values |= {
            f"bias_{i}": at[name],
            f"low_limit_{i}": signal.low,
            f"high_limit_{i}": signal.high,
        }
        if anti_windup == "back_calculation":
            values[f"tracking_time_{i}"] = float(tracking_times[i - 1])
    return values


def output_state(equations: ProcessEquations) -> dict[str, float]:
    """Return integral_i and last_output_i at rest.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.process_equations import process_equations
    >>> output_state(process_equations(cl.load("wet-well").linear))["integral_1"]
    0.0
    """
    at = equations.point.as_dict()
    state: dict[str, float] = {}
    for i, name in enumerate(equations.inputs, start=1):
        state |= {f"integral_{i}": 0.0, f"last_output_{i}": at[name]}
    return state
