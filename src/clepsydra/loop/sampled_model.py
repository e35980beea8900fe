"""The linear model of a sampled loop, exact at the sampling instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.linear_step_law import linear_step_law
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.sensitivity import largest_gain
from clepsydra.process.process import Process

#: An eigenvalue this near to the unit circle stands on it.
_ROUNDING = 1e-10


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
        """Whether every eigenvalue stands inside the unit circle, and none on it."""
        return bool(np.max(np.abs(np.linalg.eigvals(self.A))) < 1.0 - _ROUNDING)

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


def sampled_model(controller: Controller, model: LinearModel, process: Process) -> SampledModel:
    """Join the process, held over each sample, and the derivatives of the step law.

    Parameters
    ----------
    controller : Controller
    model : LinearModel
        Of the process, with all its inputs and measurements.
    process : Process

    Raises
    ------
    ClepsydraError
        The step law holds a delay ring.
    """
    law = linear_step_law(controller, process)
    held, moved = _held(model, process.sampling_period)
    controlled = [list(model.outputs).index(name) for name in process.controlled]
    enters = np.eye(len(model.outputs))[:, controlled]
    A = np.block(
        [
            [held + moved @ law.D_measurement @ model.C, moved @ law.C],
            [law.B_measurement @ model.C, law.A],
        ]
    )
    B = np.vstack([moved @ law.D_measurement, law.B_measurement]) @ enters
    C = np.hstack([model.C[controlled], np.zeros((len(controlled), len(law.A)))])
    sizes = np.array([_size(process.signal(name)) for name in process.controlled])
    return SampledModel(
        A, B * sizes, C / sizes[:, None], np.eye(len(controlled)), process.sampling_period
    )


def _size(signal: Signal) -> float:
    span = signal.high - signal.low
    return span if np.isfinite(span) else 1.0


def _held(model: LinearModel, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the state and input matrices over one period with the input held."""
    from scipy.linalg import expm

    n, m = model.B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = model.A, model.B
    whole = expm(block * period)
    return whole[:n, :n], whole[:n, n:]
