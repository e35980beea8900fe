"""The reference solver: CVODES, independent of the kernels, slow and sure."""

from __future__ import annotations

from collections import deque

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.step_law import StepLaw

Array = NDArray[np.float64]


class ReferenceIntegrator:
    """Carries a continuous system over a sampling period to the tolerance of CVODES.

    Variable-order BDF with exact Jacobians (Hindmarsh et al., SUNDIALS, ACM TOMS 31(3), 2005,
    doi 10.1145/1089014.1089020), relative tolerance 1e-10.

    Parameters
    ----------
    dynamics : casadi.Function
        SX function (x [n], held …) → dx/dt [n].
    duration : float
        Of one call [s].
    scale : float
        Size of the state; the absolute tolerance is 1e-12 of it.

    Examples
    --------
    >>> x = ca.SX.sym("x")
    >>> decay = ca.Function("decay", [x], [-x])
    >>> bool(abs(ReferenceIntegrator(decay, 1.0)(np.array([1.0]))[0] - np.exp(-1)) < 1e-9)
    True
    """

    def __init__(self, dynamics: ca.Function, duration: float, scale: float = 1.0) -> None:
        x, *held = (ca.SX.sym(f"a{i}", dynamics.numel_in(i)) for i in range(dynamics.n_in()))
        system = {"x": x, "p": ca.vertcat(*held), "ode": dynamics(x, *held)}
        options = {"reltol": 1e-10, "abstol": 1e-12 * scale, "max_num_steps": 100_000}
        self._solver = ca.integrator("reference", "cvodes", system, 0.0, duration, options)

    def __call__(self, state: Array, *held: Array) -> Array:
        """Return the state after the duration, everything but the state being held."""
        result = self._solver(x0=state, p=np.concatenate([np.zeros(0), *held]))
        return np.array(result["xf"]).ravel()


class LawEvaluation:
    """A step law evaluated by CasADi sample by sample, delay rings included.

    Parameters
    ----------
    law : StepLaw
    parameters : ndarray [p]
    state : ndarray [n]
        Initial state; the entry of a delay ring fills the whole ring.
    """

    def __init__(self, law: StepLaw, parameters: Array, state: Array) -> None:
        self._law = law
        self._parameters = parameters
        self._state = np.array(state, dtype=float)
        self._rings = {
            index: deque([float(state[index])] * entry.length)
            for index, entry in enumerate(law.state)
            if isinstance(entry, DelayRing)
        }

    @property
    def state(self) -> Array:
        """State after the last sample [n]; the entry of a delay ring is what was written."""
        return self._state.copy()

    def step(self, inputs: Array) -> Array:
        """Advance by one sample and return the outputs [q]."""
        for index, ring in self._rings.items():
            self._state[index] = ring.popleft()
        state, outputs, _ = self._law.function(self._state, inputs, self._parameters)
        self._state = np.array(state).ravel()
        for index, ring in self._rings.items():
            ring.append(float(self._state[index]))
        return np.array(outputs).ravel()
