"""The exact linear model of a process at an operating point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.linear.balance import unbalanced
from clepsydra.linear.late_outputs import reading_ages, with_late_outputs
from clepsydra.linear.linear_model import InternalDelays, LinearModel, Ports
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process

#: What a cause does to a rate over its whole range, as a share of what the strongest cause does
#: to it: less is rounding.
_ROUNDING = 1e-13


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
    measured_by_state : ndarray [q, n]
        ∂h/∂x
    """

    rates: np.ndarray
    measured: np.ndarray
    rates_by_state: np.ndarray
    rates_by_input: np.ndarray
    rates_by_disturbance: np.ndarray
    rates_by_parameter: np.ndarray
    measured_by_state: np.ndarray


class Derivatives:
    """Exact derivatives of a process by CasADi's algorithmic differentiation.

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
        self._parameters = process.parameter_values
        self._function = process.derivatives
        #: How many numbers they are at a point.
        self.size = self._function.size

    def at(
        self, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
    ) -> LocalDerivatives:
        """Return values and derivatives at a point.

        Parameters
        ----------
        state, inputs, disturbances : ndarray [n], [m], [k]
            SI.
        """
        given = (state, inputs, disturbances, self._parameters)
        rates, measured, *matrices = self._function(*given)
        return LocalDerivatives(rates.ravel(), measured.ravel(), *matrices)

    def at_each(
        self, states: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
    ) -> LocalDerivatives:
        """Return values and derivatives at points, along a first axis of each array.

        Parameters
        ----------
        states, inputs, disturbances : ndarray [k, n], [k, m], [d]
            SI.
        """
        alike = np.concatenate([disturbances, self._parameters])
        same = np.broadcast_to(alike, (len(states), len(alike)))
        rates, measured, *matrices = self._function.each(states, inputs, same)
        return LocalDerivatives(rates[..., 0], measured[..., 0], *matrices)


def linearise(point: OperatingPoint) -> LinearModel:
    """Return A = ∂f/∂x, B = ∂f/∂u, E = ∂f/∂d and C = ∂h/∂x at the point, D = 0; delays stay exact.

    What a sensor tells late is a delayed output, see `clepsydra.linear.late_outputs`.

    The derivatives are exact (algorithmic differentiation), not differences. The model has all
    inputs, disturbances and measurements; `LinearModel.select` takes some of them.

    Parameters
    ----------
    point : OperatingPoint
        It knows its process.

    Raises
    ------
    InputError
        A tank is empty at the point, where the outflow has no derivative; or it is no point.

    Examples
    --------
    The two lower tanks of Johansson's process at 3 V have time constants of 62 s and 91 s:

    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> model = linearise(find_equilibrium(load_process("quadruple-tank")))
    >>> (-1.0 / model.A.diagonal()[:2]).round(2)
    array([62.36, 90.63])
    """
    require_type(
        point, OperatingPoint, "point", "an OperatingPoint", "find it with find_equilibrium"
    )
    return _linearised(point)


@lru_cache(maxsize=16)
def _linearised(point: OperatingPoint) -> LinearModel:
    """Return the model of a point, one for all who ask, so that its parts are found once."""
    process = point.process
    for signal, value in zip(process.state, point.state, strict=True):
        if signal.unit == "m" and value <= signal.low:
            raise InputError(
                f"operating point, {signal.name}",
                float(value),
                f"a level above {signal.low:g} m",
                "choose an operating point at which no tank is empty, since the outflow of an "
                "empty tank has no derivative, or give the tank below it the outlet that it lacks",
            )
    local = Derivatives(process).at(point.state, point.inputs, point.disturbances)
    by_cause = (local.rates_by_state, local.rates_by_input, local.rates_by_disturbance)
    for matrix in (*by_cause, local.measured_by_state):
        if not np.all(np.isfinite(matrix)):
            where = f"operating point of {process.name}"
            expected = "a point at which every equation has a derivative"
            remedy = "move the operating point away from limits, floors and reversals of flow"
            raise InputError(where, point.as_dict(), expected, remedy)
    A, B, E = by_cause
    C = local.measured_by_state
    delays = None
    if process.motion.delays:
        A, B, E, delays = _with_delays(point, len(C))
    A, B, E = _without_rounding(point, A, B, E)
    groups = (process.state, process.inputs, process.disturbances, process.measurements)
    states, inputs, disturbances, outputs = (
        tuple(signal.name for signal in group) for group in groups
    )
    D = np.zeros((len(C), B.shape[1]))
    model = LinearModel(A, B, E, C, D, states, inputs, disturbances, outputs, point, delays)
    return with_late_outputs(model, reading_ages(process))


def _without_rounding(point: OperatingPoint, *by_cause: np.ndarray) -> list[np.ndarray]:
    """Return ∂f/∂x, ∂f/∂u and ∂f/∂d with zeros for what is left of terms that balance at rest.

    In a mixed tank the flows that enter and leave change no concentration when the level rises.
    Their sum leaves 10⁻¹⁸ or nothing, as the numbers happen to be, and a drifting level would
    then seem to carry the concentration along.
    """
    process = point.process
    causes = [*process.state, *process.inputs, *process.disturbances]
    values = np.concatenate([point.state, point.inputs, point.disturbances])
    spans = np.array([signal.span for signal in causes])
    sizes = np.where(np.isfinite(spans), spans, np.maximum(np.abs(values), 1.0))
    rates = np.hstack(by_cause)
    effects = np.abs(rates) * sizes
    rates[effects <= _ROUNDING * effects.max(axis=1, keepdims=True, initial=0.0)] = 0.0
    return np.split(rates, np.cumsum([len(cause.T) for cause in by_cause])[:-1], axis=1)


def _with_delays(
    point: OperatingPoint, outputs: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, InternalDelays]:
    """Return A, B, E with the delayed quantities held, and what leaves and enters the delays.

    The contents c = c(x) are integrated, dc/dt = f(c, z, …); at rest Δẋ = (∂c/∂x)⁻¹ Δċ. A
    concentration is an amount in a volume: by way of both, a level that rises by itself changes
    no concentration, also not of what is sent.
    """
    process, motion = point.process, point.process.motion
    parameters = process.parameter_values
    slopes = _slopes(motion.to_contents, [point.state, parameters], "x")
    held = motion.at_rest(point.state, point.inputs, point.disturbances, parameters)
    matrix = _slopes(motion.rates, held, "cudz")
    at = Ports.of(len(slopes), len(point.inputs), len(point.disturbances), 0, len(motion.delays))
    back, terms = np.linalg.inv(slopes), np.abs(matrix)
    matrix[at.x] = np.linalg.solve(slopes, matrix[at.x])
    matrix[:, at.x] = matrix[:, at.x] @ slopes
    terms[at.x] = np.abs(back) @ terms[at.x]
    terms[:, at.x] = terms[:, at.x] @ np.abs(slopes)
    matrix = unbalanced(matrix, terms)
    rates, sent = matrix[at.x], matrix[at.w]
    delays = InternalDelays(
        np.array([delay.time for delay in motion.delays]),
        rates[:, at.z],
        sent[:, at.x],
        sent[:, at.u],
        sent[:, at.d],
        sent[:, at.z],
        np.zeros((outputs, len(motion.delays))),
    )
    return rates[:, at.x], rates[:, at.u], rates[:, at.d], delays


def _slopes(function: ca.Function, at: list[np.ndarray], by: str) -> np.ndarray:
    """Return how the first two results of a function change with some of its arguments."""
    symbols = {name: ca.SX.sym(name, function.numel_in(name)) for name in function.name_in()}
    found = ca.vertcat(*function.call(list(symbols.values()))[:2])
    slope = ca.jacobian(found, ca.vertcat(*(symbols[name] for name in by)))
    return np.array(ca.Function("slope", list(symbols.values()), [slope])(*at))


def operating_point_of(model: LinearModel) -> OperatingPoint:
    """Return the operating point that a model was made at, and with it the process.

    Raises
    ------
    InputError
        The model has none, as one that came from python-control; or it is no model.
    """
    require_type(
        model, LinearModel, "model", "a LinearModel", "make it with linearise, or by analyse"
    )
    if model.point is None:
        expected = "a model of a process at an operating point"
        remedy = "make it by linearise(point), or give it its point by dataclasses.replace"
        raise InputError("linear model, point", None, expected, remedy)
    return model.point
