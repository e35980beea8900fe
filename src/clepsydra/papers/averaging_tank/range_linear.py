"""A controller on the linear model of the tank, under the limits of its inputs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clepsydra.base.signal import path
from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_process import held_over
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of


def linear_errors(
    controller: Controller, model: LinearModel, sizes: Mapping[str, float], horizon: float
) -> dict[str, float]:
    """Return ∫ |e| dt after steps of setpoints, with the process as its linear model.

    The inputs keep their limits, so that what is left of a decline is no nonlinearity of the
    process. Held over each sample the linear model is exact.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
    sizes : mapping
        Controlled measurement to the step of its setpoint [its unit].
    horizon : float
        [s]

    Examples
    --------
    Without limits it is as large as the step: twice the step, twice the error.

    >>> from clepsydra.papers.averaging_tank.range_controllers import controller_of
    >>> from clepsydra.papers.averaging_tank.step_run import high_model_of
    >>> pair = controller_of("outflow", "LQI", 0.1), high_model_of("outflow", 0.1)
    >>> small, large = (linear_errors(*pair, {"volume": size}, 20.0) for size in (0.01, 0.02))
    >>> round(large["volume"] / small["volume"], 9)
    2.0
    """
    point = operating_point_of(model)
    period, at = point.process.sampling_period, point.as_dict()
    seen = model.select(controller.measurements, controller.manipulated)
    held, moved = held_over(seen.A, seen.B, period)
    law = controller.law
    rest_y = np.array([at[name] for name in controller.measurements])
    rest_u = np.array([at[name] for name in controller.manipulated])
    given = {signal.name: signal.initial for signal in law.inputs} | {"time_step": period}
    given |= {path(name, "sp"): at[name] + sizes.get(name, 0.0) for name in controller.setpoints}
    names = [signal.name for signal in law.inputs]
    places = [names.index(path(name, "pv")) for name in controller.measurements]
    rows = [i for i, signal in enumerate(law.outputs) if signal.part == "out"]
    inputs = np.array([given[signal.name] for signal in law.inputs])
    parameters = [controller.values[parameter.name] for parameter in law.parameters]
    state = np.array([controller.initial_state[entry.name] for entry in law.state])
    x = np.zeros(len(seen.states))
    targets = np.array([at[name] + size for name, size in sizes.items()])
    shown = [controller.measurements.index(name) for name in sizes]
    errors = []
    for _ in range(round(horizon / period) + 1):
        y = rest_y + seen.C @ x
        errors.append(np.abs(targets - y[shown]))
        inputs[places] = y
        following, outputs, _ = law.function(state, inputs, parameters)
        state = following.full().ravel()
        u = outputs.full().ravel()[rows]
        x = held @ x + moved @ (u - rest_u)
    found = np.trapezoid(np.array(errors), dx=period, axis=0)
    return dict(zip(sizes, map(float, found), strict=True))
