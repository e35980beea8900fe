"""The linear model of a step law, by differentiating it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.blocks.validity import LARGEST_NUMBER
from clepsydra.controllers.parameters import remembers
from clepsydra.program.entries import is_ring
from clepsydra.program.step_law import StepLaw


@dataclass(frozen=True, eq=False)
class LinearStepLaw:
    """A step law in automatic, away from its limits, from one sample to the next.

    x(k+1) = A x(k) + B_setpoint r(k) + B_measurement y(k),
    u(k) = C x(k) + D_setpoint r(k) + D_measurement y(k), with r, y and u in the order of the
    law's sp, pv and out.
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
        # Gains that are as they were: no change of them is differentiated.
        at = {**state, **{name: values[parameter] for name, parameter in self._remembered}}
        step_x, step_u, output_x, output_u = self.law.jacobians(
            [at.get(name, 0.0) for name in self._states],
            [inputs.get(name, 0.0) if usual is None else usual for name, usual in self._inputs],
            [values[name] if end is None else end for name, end in self._parameters],
        )
        step_x, step_u, output_x = self._with_rings(step_x, step_u, output_x)
        rows, setpoints, measurements = self._outputs, self._setpoints, self._measurements
        read = np.any(step_x != 0.0, axis=0) | np.any(output_x[rows] != 0.0, axis=0)
        # What nothing moves is a constant, as the bias of a P controller, and no mode of the loop.
        moved = np.any(step_x != np.eye(len(step_x)), axis=1)
        moved |= np.any(step_u[:, [*setpoints, *measurements]] != 0.0, axis=1)
        read &= moved
        return LinearStepLaw(
            A=step_x[read][:, read],
            B_setpoint=step_u[read][:, setpoints],
            B_measurement=step_u[read][:, measurements],
            C=output_x[rows][:, read],
            D_setpoint=output_u[rows][:, setpoints],
            D_measurement=output_u[rows][:, measurements],
        )

    def _with_rings(
        self, step_x: np.ndarray, step_u: np.ndarray, output_x: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the matrices with every number that a ring holds as a state."""
        for place, more in self._longer.items():
            n = len(step_x)
            step_x, step_u = np.pad(step_x, (0, more)), np.pad(step_u, ((0, more), (0, 0)))
            output_x = np.pad(output_x, ((0, 0), (0, more)))
            for matrix in (step_x, step_u):
                matrix[n], matrix[place] = matrix[place], 0.0
            step_x[[*range(n + 1, n + more), place], range(n, n + more)] = 1.0
        return step_x, step_u, output_x


def _places(signals: Sequence[Signal], part: str) -> list[int]:
    """Return where the signals stand that are one part."""
    return [place for place, signal in enumerate(signals) if signal.part == part]
