"""The linear model of a sampled loop, exact at the sampling instants."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.controllers.controller import Controller
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.sensitivity import largest_gain
from clepsydra.program.delay_ring import DelayRing


@dataclass(frozen=True)
class SampledModel:
    """x(k+1) = A x(k) + B d(k), e(k) = C x(k) + D d(k): the output sensitivity of a loop.

    d is added to the controlled measurements as they reach the step law, and e is what the
    law then sees of them, both as shares of the measurements' ranges. So D is the identity.

    Parameters
    ----------
    A, B, C, D : ndarray
    sampling_period : float
        [s]
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    sampling_period: float

    @property
    def is_stable(self) -> bool:
        """Whether every eigenvalue stands inside the unit circle."""
        return bool(np.max(np.abs(np.linalg.eigvals(self.A))) < 1.0)

    @property
    def maximum_sensitivity(self) -> float:
        """Largest singular value of S(e^jωT) over frequency [1]; infinite if unstable."""
        if not self.is_stable:
            return float("inf")
        # The bilinear map takes the unit circle to the imaginary axis and keeps every gain.
        identity = np.eye(len(self.A))
        inverse = np.linalg.inv(self.A + identity)
        return largest_gain(
            (self.A - identity) @ inverse,
            np.sqrt(2.0) * inverse @ self.B,
            np.sqrt(2.0) * self.C @ inverse,
            self.D - self.C @ inverse @ self.B,
        ).peak


def sampled_model(
    controller: Controller, model: LinearModel, point: OperatingPoint
) -> SampledModel:
    """Linearise a loop at rest: the held process exactly, the step law by its derivatives.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        With all measurements of the process as outputs.
    point : OperatingPoint

    Raises
    ------
    ClepsydraError
        The step law holds a delay ring.
    """
    process, law = point.process, controller.law
    if any(isinstance(entry, DelayRing) for entry in law.state):
        raise ClepsydraError(f"{controller.name}: no linear model of a law with a delay ring yet")
    period = process.sampling_period
    held, moved = _held(model, period)
    gains = _LawDerivatives(controller, point)
    rows = [list(model.outputs).index(name) for name in controller.measurements]
    seen = model.C[rows]
    order = [list(model.inputs).index(name) for name in controller.manipulated]
    moved = moved[:, order]
    names = list(process.controlled)
    enters = np.array([[float(m == y) for y in names] for m in controller.measurements])
    signals = [process.signal(name) for name in names]
    sizes = np.diag([y.high - y.low if np.isfinite(y.high - y.low) else 1.0 for y in signals])
    A = np.block(
        [
            [held + moved @ gains.output_by_measurement @ seen, moved @ gains.output_by_state],
            [gains.state_by_measurement @ seen, gains.state_by_state],
        ]
    )
    B = np.vstack(
        [moved @ gains.output_by_measurement @ enters, gains.state_by_measurement @ enters]
    )
    controlled = model.C[[list(model.outputs).index(name) for name in names]]
    C = np.hstack([controlled, np.zeros((len(names), len(gains.state_by_state)))])
    inverse = np.linalg.inv(sizes)
    return SampledModel(A, B @ sizes, inverse @ C, np.eye(len(names)), period)


class _LawDerivatives:
    """Derivatives of a step law at rest, in automatic with sound sensors."""

    def __init__(self, controller: Controller, point: OperatingPoint) -> None:
        law, process = controller.law, point.process
        at = point.as_dict()
        inputs = {"time_step": process.sampling_period}
        for number, name in enumerate(controller.measurements, 1):
            inputs[f"measurement_{number}"] = at[name]
            inputs[f"sensor_{number}"] = 1.0
        for number, name in enumerate(controller.setpoints, 1):
            inputs[f"setpoint_{number}"] = at[name]
        for number, name in enumerate(controller.manipulated, 1):
            inputs |= {f"mode_{number}": 1.0, f"manual_{number}": at[name]}
            inputs[f"tracking_{number}"] = at[name]
        symbols = [ca.SX.sym(name, law.function.numel_in(i)) for i, name in enumerate("xup")]
        next_state, outputs, _ = law.function(*symbols)
        manipulated = [
            index for index, s in enumerate(law.outputs) if s.name.startswith("manipulated_")
        ]
        measured = [
            index for index, s in enumerate(law.inputs) if s.name.startswith("measurement_")
        ]
        moved = outputs[manipulated]
        derivatives = ca.Function(
            "derivatives",
            symbols,
            [
                ca.jacobian(next_state, symbols[0]),
                ca.jacobian(next_state, symbols[1])[:, measured],
                ca.jacobian(moved, symbols[0]),
                ca.jacobian(moved, symbols[1])[:, measured],
            ],
        )
        values = derivatives(
            [controller.initial_state[entry.name] for entry in law.state],
            [inputs[signal.name] for signal in law.inputs],
            [controller.values[signal.name] for signal in law.parameters],
        )
        (
            self.state_by_state,
            self.state_by_measurement,
            self.output_by_state,
            self.output_by_measurement,
        ) = (np.array(value) for value in values)


def _held(model: LinearModel, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the state and input matrices over one period with the input held."""
    from scipy.linalg import expm

    n, m = model.B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = model.A, model.B
    whole = expm(block * period)
    return whole[:n, :n], whole[:n, n:]
