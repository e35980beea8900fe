"""An operating point: a state in which nothing moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.process.process import Process


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """An equilibrium of a process, in SI.

    Parameters
    ----------
    state : ndarray [n]
    inputs : ndarray [m]
    disturbances : ndarray [k]
    measurements : ndarray [q]
    residual : float
        Largest |dx/dt| left [state unit per second].
    warnings : tuple of str
        What is unusual about it: an empty tank, a level that the given signals leave open.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> round(point.as_dict()["level_1"], 6)
    6.131484
    """

    process: Process
    state: np.ndarray
    inputs: np.ndarray
    disturbances: np.ndarray
    measurements: np.ndarray
    residual: float
    warnings: tuple[Remark, ...] = ()

    @classmethod
    def at(
        cls, process: Process, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray
    ) -> OperatingPoint:
        """Return what is measured with these values, at rest or not, and how fast it moves."""
        parameters = process.parameter_values
        rates = np.array(process.dynamics(state, inputs, disturbances, parameters)).ravel()
        measured = np.array(process.measure(state, parameters)).ravel()
        residual = float(np.abs(rates).max(initial=0.0))
        return cls(process, state, inputs, disturbances, measured, residual)

    def as_dict(self) -> dict[str, float]:
        """Return every signal's value by name, SI."""
        process = self.process
        groups = (process.state, process.inputs, process.disturbances, process.measurements)
        values = (self.state, self.inputs, self.disturbances, self.measurements)
        return {
            signal.name: float(value)
            for group, numbers in zip(groups, values, strict=True)
            for signal, value in zip(group, numbers, strict=True)
        }
