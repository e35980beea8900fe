"""The exact derivatives of a process, as one CasADi function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from clepsydra.process.process import Process


@dataclass(frozen=True)
class LocalDerivatives:
    """A process near one point: ẋ, y and how they change with every argument, in SI.

    Parameters
    ----------
    rates : ndarray [n]
        ẋ = f(x, u, d, p).
    measured : ndarray [q]
        y = h(x, p).
    rates_by_state, rates_by_input, rates_by_disturbance, rates_by_parameter : ndarray
        ∂f/∂x [n, n], ∂f/∂u [n, m], ∂f/∂d [n, k], ∂f/∂p [n, l].
    measured_by_state, measured_by_parameter : ndarray
        ∂h/∂x [q, n], ∂h/∂p [q, l].

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> local = Derivatives(load_process("quadruple-tank")).at(
    ...     np.full(4, 0.1), np.full(2, 3.0), np.zeros(2)
    ... )
    >>> local.rates_by_input.shape, local.measured
    ((4, 2), array([5., 5., 5., 5.]))
    """

    rates: np.ndarray
    measured: np.ndarray
    rates_by_state: np.ndarray
    rates_by_input: np.ndarray
    rates_by_disturbance: np.ndarray
    rates_by_parameter: np.ndarray
    measured_by_state: np.ndarray
    measured_by_parameter: np.ndarray


class Derivatives:
    """Exact derivatives of a process by CasADi's algorithmic differentiation.

    Parameters
    ----------
    process : Process

    Examples
    --------
    The sensors of the quadruple tank show 0.5 V for each centimetre:

    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> level = np.full(4, 0.1)
    >>> Derivatives(process).at(level, np.full(2, 3.0), np.zeros(2)).measured_by_state[0, :2]
    array([50.,  0.])
    """

    def __init__(self, process: Process) -> None:
        x = ca.SX.sym("x", len(process.state))
        u = ca.SX.sym("u", len(process.inputs))
        d = ca.SX.sym("d", len(process.disturbances))
        p = ca.SX.sym("p", len(process.parameters))
        f, h = process.dynamics(x, u, d, p), process.measure(x, p)
        self._parameters = process.parameter_values
        results = [f, h] + [ca.jacobian(f, v) for v in (x, u, d, p)]
        results += [ca.jacobian(h, v) for v in (x, p)]
        self._function = ca.Function("derivatives", [x, u, d, p], [ca.densify(r) for r in results])
        self._shapes = [self._function.size_out(place) for place in range(len(results))]

    def at(
        self, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
    ) -> LocalDerivatives:
        """Return values and derivatives at a point.

        Parameters
        ----------
        state, inputs, disturbances : ndarray [n], [m], [k]
            SI.
        """
        # An equilibrium is searched by hundreds of evaluations: CasADi's own matrices would cost
        # five times as much as the numbers in them.
        given = (state, inputs, disturbances, self._parameters)
        arguments = [np.ascontiguousarray(values, float) for values in given]
        found = [np.empty(shape, order="F") for shape in self._shapes]
        buffer: Any  # CasADi's types ask for a size, which a view brings along
        buffer, evaluate = self._function.buffer()
        for place, values in enumerate(arguments):
            buffer.set_arg(place, values.data)
        for place, matrix in enumerate(found):
            buffer.set_res(place, matrix.T.data)
        evaluate()
        rates, measured, *matrices = found
        return LocalDerivatives(rates.ravel(), measured.ravel(), *matrices)
