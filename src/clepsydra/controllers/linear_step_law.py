"""The linear model of a step law, by differentiating it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.parameters import remembers
from clepsydra.program.dense_function import DenseFunction
from clepsydra.program.entries import is_ring
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True, eq=False)
class LinearStepLaw:
    """A step law in automatic, away from its limits, from one sample to the next.

    x(k+1) = A x(k) + B_setpoint r(k) + B_measurement y(k),
    u(k) = C x(k) + D_setpoint r(k) + D_measurement y(k), with r, y and u in the order of the
    law's sp, pv and out. A stack of models has a stack [k, rows, columns] of each matrix.
    """

    A: np.ndarray
    B_setpoint: np.ndarray
    B_measurement: np.ndarray
    C: np.ndarray
    D_setpoint: np.ndarray
    D_measurement: np.ndarray


class StepLawDerivatives:
    """The derivatives of a step law, built once and evaluated for any parameter values.

    Those of expressions are exact, those of a law in Python are differences. A delay ring of n
    samples counts as n states, of which the law reads the oldest.

    Examples
    --------
    A PI controller with K = 2 V/V and Ti = 10 s at a time step of 1 s:

    >>> from clepsydra.controllers.pid import multiloop_pid_law
    >>> law = multiloop_pid_law(["level"], ["pump"])
    >>> values = dict(proportional_gain=2.0, integral_time=10.0, setpoint_weight=1.0,
    ...               tracking_time=10.0, low_limit=0.0, high_limit=10.0)
    >>> named = {parameter.name: values[parameter.part] for parameter in law.parameters}
    >>> model = StepLawDerivatives(law).at(named, {}, {"time_step": 1.0})
    >>> float(model.B_setpoint[0, 0]), float(model.D_measurement[0, 0])
    (0.2, -2.0)
    """

    def __init__(self, law: StepLaw) -> None:
        self.law = law
        self._longer = {
            place: entry.length - 1 for place, entry in enumerate(law.state) if is_ring(entry)
        }
        usual = {"mode": float(Mode.AUTOMATIC), "good": 1.0}
        ends = {"low_limit": -LARGEST_NUMBER, "high_limit": LARGEST_NUMBER}
        self._states = [entry.name for entry in law.state]
        self._inputs = [(signal.name, usual.get(signal.part)) for signal in law.inputs]
        self._parameters = [(each.name, ends.get(each.part)) for each in law.parameters]
        self._remembered = remembers(law, {name for name, _ in self._parameters})
        self._outputs = _places(law.outputs, "out")
        self._setpoints = _places(law.inputs, "sp")
        self._measurements = _places(law.inputs, "pv")

    def at(
        self,
        values: Mapping[str, float],
        state: Mapping[str, float],
        inputs: Mapping[str, float],
    ) -> LinearStepLaw:
        """Return the linear model in automatic with sound sensors and the limits far away.

        `values`: parameter name to value; `state`, `inputs`: state and input names to where the law
        is differentiated; zero for the others.

        Returns
        -------
        LinearStepLaw
            Its states are those that move and that something depends on in automatic, in the
            law's order; the last output, for one, is left out, and the bias of proportional
            control.
        """
        matrices = self._with_rings(*self.law.jacobians(*self._vectors(values, state, inputs)))
        return self._among(self._modes(*matrices), *matrices)

    def each(
        self,
        values: Mapping[str, ArrayLike],
        state: Mapping[str, float],
        inputs: Mapping[str, float],
    ) -> list[tuple[np.ndarray, LinearStepLaw]]:
        """Return the linear models for k parameter values, those of the same states as a stack.

        `values`: parameter name to its value for all, or to its values [k]; the others as in `at`.

        Returns
        -------
        list of (ndarray, LinearStepLaw)
            Which of the k are in a stack, and the stack.
        """
        jacobians = self.law.jacobians
        assert isinstance(jacobians, DenseFunction)  # a law in Python is no expression
        (count,) = np.broadcast_shapes(*map(np.shape, values.values()))
        tables = (_table(vector, count) for vector in self._vectors(values, state, inputs))
        matrices = self._with_rings(*jacobians.each(*tables))
        alike: dict[bytes, list[int]] = {}
        every = self._modes(*matrices)
        for place, modes in enumerate(every):
            alike.setdefault(modes.tobytes(), []).append(place)
        return [
            (np.array(places), self._among(every[places[0]], *(each[places] for each in matrices)))
            for places in alike.values()
        ]

    def expressions(self, inputs: Mapping[str, float]) -> tuple[ca.SX, ca.SX, list[ca.SX]]:
        """Return symbols of parameters and state, and what `at` takes its matrices from, of them.

        Returns
        -------
        parameters, state : casadi.SX [p], [n]
            In the law's order; what lies far away counts as such whatever its symbol is, and so
            does what a law remembers of its parameters.
        matrices : list of casadi.SX
            ∂x⁺/∂x, ∂x⁺/∂w, ∂u/∂x and ∂u/∂w with w the law's sp, then its pv, and u its out, each
            in the law's order. A delay ring is one state.
        """
        law = self.law
        parameters = ca.SX.sym("parameter", len(law.parameters))
        state = ca.SX.sym("state", len(self._states))
        names = [each.name for each in law.parameters]
        values, rest = (
            dict(zip(of, ca.vertsplit(symbols), strict=True))
            for of, symbols in ((names, parameters), (self._states, state))
        )
        x, u, p = (ca.SX.sym(name, law.function.numel_in(k)) for k, name in enumerate("xup"))
        next_state, outputs, _ = law.function(x, u, p)
        driven, moved = [*self._setpoints, *self._measurements], self._outputs
        slopes = [
            ca.jacobian(next_state, x),
            ca.jacobian(next_state, u)[:, driven],
            ca.jacobian(outputs, x)[moved, :],
            ca.jacobian(outputs, u)[moved, driven],
        ]
        at = [ca.vertcat(*vector) for vector in self._vectors(values, rest, inputs)]
        return parameters, state, ca.substitute(slopes, [x, u, p], at)

    def _vectors(
        self,
        values: Mapping[str, Any],
        state: Mapping[str, Any],
        inputs: Mapping[str, float],
    ) -> tuple[list[Any], list[Any], list[Any]]:
        """Return state, inputs and parameters of the law, each a number or numbers [k]."""
        # Gains that are as they were: no change of them is differentiated.
        at = {**state, **{name: values[parameter] for name, parameter in self._remembered}}
        return (
            [at.get(name, 0.0) for name in self._states],
            [inputs.get(name, 0.0) if usual is None else usual for name, usual in self._inputs],
            [values[name] if end is None else end for name, end in self._parameters],
        )

    def _modes(
        self, step_x: np.ndarray, step_u: np.ndarray, output_x: np.ndarray, output_u: np.ndarray
    ) -> np.ndarray:
        """Return which states move and are read [..., n]."""
        read = np.any(step_x != 0.0, axis=-2)
        read |= np.any(output_x[..., self._outputs, :] != 0.0, axis=-2)
        # What nothing moves is a constant, as the bias of a P controller, and no mode of the loop.
        moved = np.any(step_x != np.eye(step_x.shape[-1]), axis=-1)
        driven = step_u[..., [*self._setpoints, *self._measurements]]
        moved |= np.any(driven != 0.0, axis=-1)
        return read & moved

    def _among(
        self,
        modes: np.ndarray,
        step_x: np.ndarray,
        step_u: np.ndarray,
        output_x: np.ndarray,
        output_u: np.ndarray,
    ) -> LinearStepLaw:
        """Return the model of some states [n] alone."""
        step_u, output_x = step_u[..., modes, :], output_x[..., self._outputs, :]
        output_u = output_u[..., self._outputs, :]
        return LinearStepLaw(
            A=step_x[..., modes, :][..., modes],
            B_setpoint=step_u[..., self._setpoints],
            B_measurement=step_u[..., self._measurements],
            C=output_x[..., modes],
            D_setpoint=output_u[..., self._setpoints],
            D_measurement=output_u[..., self._measurements],
        )

    def _with_rings(
        self, step_x: np.ndarray, step_u: np.ndarray, output_x: np.ndarray, output_u: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the matrices with every number that a ring holds as a state."""
        for place, more in self._longer.items():
            n = step_x.shape[-1]
            step_x = _wider(step_x, more, more)
            step_u, output_x = _wider(step_u, more, 0), _wider(output_x, 0, more)
            for matrix in (step_x, step_u):
                matrix[..., n, :] = matrix[..., place, :]
                matrix[..., place, :] = 0.0
            step_x[..., [*range(n + 1, n + more), place], range(n, n + more)] = 1.0
        return step_x, step_u, output_x, output_u


def _wider(matrix: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return a matrix, or a stack of them, with so many more rows and columns of zeros."""
    return np.pad(matrix, [(0, 0)] * (matrix.ndim - 2) + [(0, rows), (0, columns)])


def _table(vector: Sequence[ArrayLike], count: int) -> np.ndarray:
    """Return a vector of numbers, some of which have several values, as rows [count, size]."""
    table = np.empty((count, len(vector)))
    for column, value in zip(table.T, vector, strict=True):
        column[:] = value
    return table


def _places(signals: Sequence[Signal], part: str) -> list[int]:
    """Return where the signals stand that are one part."""
    return [place for place, signal in enumerate(signals) if signal.part == part]
