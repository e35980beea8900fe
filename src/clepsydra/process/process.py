"""A process: its signals and one set of equations, joined from elements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal

if TYPE_CHECKING:
    from clepsydra.process.element import Element


@dataclass(frozen=True)
class Process:
    """What is controlled: tanks, flows, pumps and sensors as one set of CasADi equations.

    Parameters
    ----------
    name, title, source : str
        Identifier, one line for the reader, and where the numbers come from.
    state : tuple of Signal
        Levels "tank_1.level" [m], ranges from the floor to the rim.
    inputs : tuple of Signal
        Manipulated variables "pump_1" with their range; `initial` is the nominal value.
    disturbances : tuple of Signal
        Inputs that nobody manipulates, "inflow_1" [m³/s].
    measurements : tuple of Signal
        Sensors "level_1" with their range, in the order of the file.
    controlled : tuple of str
        The measurements that follow setpoints.
    parameters : tuple of Signal
        Element parameters "tank_1.area" with their value in `initial`.
    dynamics : casadi.Function
        SX function (x [n], u [m], d [k], p [l]) → dx/dt [n], SI.
    measure : casadi.Function
        SX function (x [n], p [l]) → y [q], in the unit of each measurement.
    measured_state : mapping
        Measurement name to the state that it shows, "level_1" → "tank_1.level".
    elements : tuple of Element
        The parts, for the drawing and for messages.
    nominal_outputs : mapping
        Measurement name to a value where the file fixes the operating point by outputs;
        empty where it is fixed by the inputs' nominal values.
    sampling_period : float
        Of the controllers [s].
    path : Path or None
        The file that it was read from; None for a process of the catalogue.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> process.signal("level_1").high, process.measured_state["level_1"]
    (10.0, 'tank_1.level')
    """

    name: str
    title: str
    source: str
    state: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    disturbances: tuple[Signal, ...]
    measurements: tuple[Signal, ...]
    controlled: tuple[str, ...]
    parameters: tuple[Signal, ...]
    dynamics: ca.Function
    measure: ca.Function
    measured_state: dict[str, str]
    elements: tuple[Element, ...]
    nominal_outputs: dict[str, float]
    sampling_period: float
    path: Path | None = None

    @property
    def parameter_values(self) -> np.ndarray:
        """The parameters' values [l], SI."""
        return np.array([parameter.initial for parameter in self.parameters])

    def signal(self, name: str) -> Signal:
        """Return the state, input, disturbance, measurement or parameter of that name.

        Raises
        ------
        KeyError
            There is none.
        """
        for group in (self.state, self.inputs, self.disturbances, self.measurements):
            for signal in group:
                if signal.name == name:
                    return signal
        for signal in self.parameters:
            if signal.name == name:
                return signal
        raise KeyError(name)
