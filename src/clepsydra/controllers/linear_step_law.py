"""The linear model of a controller, taken from its step law."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.controller import Controller
from clepsydra.process.process import Process


@dataclass(frozen=True, eq=False)
class LinearStepLaw:
    """A step law in automatic, away from its limits, from one sample to the next.

    x(k+1) = A x(k) + B_setpoint r(k) + B_measurement y(k),
    u(k) = C x(k) + D_setpoint r(k) + D_measurement y(k), with r, y and u in the order of the
    process's controlled measurements, measurements and inputs.

    Parameters
    ----------
    A, B_setpoint, B_measurement, C, D_setpoint, D_measurement : ndarray
    """

    A: np.ndarray
    B_setpoint: np.ndarray
    B_measurement: np.ndarray
    C: np.ndarray
    D_setpoint: np.ndarray
    D_measurement: np.ndarray


def linear_step_law(controller: Controller, process: Process) -> LinearStepLaw:
    """Return the linear model of a controller by differentiating its step law.

    States that nothing depends on in automatic (the last output) are left out.

    Parameters
    ----------
    controller : Controller
    process : Process
        It gives the order of the signals and the sampling period.

    Returns
    -------
    LinearStepLaw
        States in the law's order; inputs that the controller does not move have zero rows.

    Raises
    ------
    ClepsydraError
        The law keeps a delay ring.

    Examples
    --------
    A PI controller with K = 2 V/V and Ti = 10 s, sampled at 1 s, on one tank of 50 s:

    >>> from clepsydra.controllers.proportional_integral import FAMILY, multiloop_pi_law
    >>> x, u, none = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX(0, 1)
    >>> tank = Process("tank", "", "", (Signal("tank.level", "m"),), (Signal("pump", "V"),), (),
    ...                (Signal("level", "V"),), ("level",), (),
    ...                ca.Function("f", [x, u, none, none], [-x / 50 + u]),
    ...                ca.Function("g", [x, none], [x]), {"level": "tank.level"}, (), {}, 1.0)
    >>> values = dict(proportional_gain_1=2.0, integral_time_1=10.0, setpoint_weight_1=1.0,
    ...               low_limit_1=0.0, high_limit_1=10.0)
    >>> pi = Controller("PI", FAMILY, "by hand", multiloop_pi_law(1, "clamping"), values,
    ...                 {"integral_1": 0.0, "last_output_1": 0.0}, ("level",), ("level",),
    ...                 ("pump",))
    >>> model = linear_step_law(pi, tank)
    >>> float(model.B_setpoint[0, 0]), float(model.D_measurement[0, 0])
    (0.2, -2.0)
    """
    law = controller.law
    if not all(isinstance(state, Signal) for state in law.state):
        raise ClepsydraError(
            f"{controller.name}: a step law with a delay ring has no linear model here"
        )
    step_x, step_u, output_x, output_u = _jacobians(controller, process.sampling_period)
    outputs = [signal.name for signal in law.outputs]
    inputs = [signal.name for signal in law.inputs]
    rows = [outputs.index(f"manipulated_{i + 1}") for i in range(len(controller.manipulated))]
    from_setpoints = [inputs.index(f"setpoint_{j + 1}") for j in range(len(controller.setpoints))]
    from_measurements = [
        inputs.index(f"measurement_{j + 1}") for j in range(len(controller.measurements))
    ]
    read = np.any(step_x != 0.0, axis=0) | np.any(output_x[rows] != 0.0, axis=0)

    setpoints = _placement(controller.setpoints, process.controlled)
    measurements = _placement(controller.measurements, [s.name for s in process.measurements])
    manipulated = _placement(controller.manipulated, [s.name for s in process.inputs]).T
    return LinearStepLaw(
        A=step_x[np.ix_(read, read)],
        B_setpoint=step_u[read][:, from_setpoints] @ setpoints,
        B_measurement=step_u[read][:, from_measurements] @ measurements,
        C=manipulated @ output_x[rows][:, read],
        D_setpoint=manipulated @ output_u[rows][:, from_setpoints] @ setpoints,
        D_measurement=manipulated @ output_u[rows][:, from_measurements] @ measurements,
    )


def _jacobians(controller: Controller, time_step: float) -> list[np.ndarray]:
    """Return ∂(next state, output)/∂(state, inputs) in automatic with the limits far away."""
    law = controller.law
    state, inputs, parameters = (
        ca.SX.sym(n, law.function.numel_in(k)) for k, n in enumerate("xup")
    )
    next_state, outputs, _ = law.function(state, inputs, parameters)
    function = ca.Function(
        "jacobians",
        [state, inputs, parameters],
        [
            ca.densify(ca.jacobian(expression, symbols))
            for expression in (next_state, outputs)
            for symbols in (state, inputs)
        ],
    )
    given: dict[str, float] = {"time_step": time_step}
    given |= {s.name: Mode.AUTOMATIC for s in law.inputs if s.name.startswith("mode_")}
    given |= {s.name: 1.0 for s in law.inputs if s.name.startswith("sensor_")}
    limits = {
        s.name: -LARGEST_NUMBER if s.name.startswith("low_limit_") else LARGEST_NUMBER
        for s in law.parameters
        if s.name.startswith(("low_limit_", "high_limit_"))
    }
    values = controller.values | limits
    results = function(
        [controller.initial_state[state.name] for state in law.state],
        [given.get(signal.name, 0.0) for signal in law.inputs],
        [values[parameter.name] for parameter in law.parameters],
    )
    return [np.array(result) for result in results]


def _placement(names: tuple[str, ...], order: tuple[str, ...] | list[str]) -> np.ndarray:
    """Return the matrix that picks `names` out of signals in `order`."""
    placement = np.zeros((len(names), len(order)))
    for row, name in enumerate(names):
        placement[row, list(order).index(name)] = 1.0
    return placement
