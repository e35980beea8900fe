"""A process: its signals and one set of equations, joined from elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import casadi as ca
import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.process.alarm import Alarm
from clepsydra.process.component import Component
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.equations import Equations
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.program.dense_function import DenseFunction


@dataclass(frozen=True, kw_only=True)
class Process(Equations):
    """What is controlled: tanks, flows, pumps and sensors as one set of CasADi equations.

    Parameters
    ----------
    name, title, source : str
        Identifier, one line for the reader, and where the numbers come from.
    controlled : tuple of str
        The measurements that follow setpoints.
    elements : tuple of Element
        The parts, for the drawing and for messages.
    nominal_outputs : mapping
        Measurement name to a value where the file fixes the operating point by outputs;
        empty where it is fixed by the inputs' nominal values.
    sampling_period : float
        Of the controllers [s].
    path : Path or None
        The file that it was read from; None for a process of the catalogue.
    components : tuple of Component
        What is dissolved in the liquid.
    variant : tuple of str
        Of the file, in force, in the order in which they were laid over it.
    variants : mapping
        Every variant of the file to its description.
    warnings : tuple of str
        What of a user's file has no effect.
    averaging : tuple of str
        Those controlled measurements whose tank is there to smooth the flow through it.
    bands : mapping
        Those of them that loads must leave in a band to its ends [unit of the measurement].
    drawn : int
        The number from which its holes, splits and gains are drawn; 0 for those of the file.
    uncertainty : Uncertainty
        How its parameters are distributed about their values.
    document : Document or None
        What that file says, with its lines.
    tags : mapping
        Signal, or element, to the name that it has in the plant's control system: exports show
        that in its place.

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
    controlled: tuple[str, ...]
    elements: tuple[Element, ...]
    nominal_outputs: dict[str, float]
    sampling_period: float
    path: Path | None = None
    components: tuple[Component, ...] = ()
    variant: tuple[str, ...] = ()
    variants: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[Remark, ...] = ()
    averaging: tuple[str, ...] = ()
    bands: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    tags: Mapping[str, str] = field(default_factory=dict)
    drawn: int = 0
    alarms: tuple[Alarm, ...] = ()
    uncertainty: Uncertainty = field(default_factory=Uncertainty)
    document: Document | None = field(default=None, compare=False, repr=False)

    @cached_property
    def show(self) -> ca.Function:
        """SX function (x [n], p [l]) → y [q]: what the sensors show of a state without noise."""
        x, p = (ca.SX.sym(name, self.measure.numel_in(i)) for i, name in enumerate("xp"))
        return ca.Function("show", [x, p], [self.display(self.measure(x, p))], ["x", "p"], ["y"])

    @cached_property
    def derivatives(self) -> DenseFunction:
        """Function (x [n], u [m], d [k], p [l]) → dx/dt, y, and their slopes, of numbers.

        Those of dx/dt are by x, u, d and p, those of y by x.
        """
        x, u, d, p = (ca.SX.sym(n, self.dynamics.numel_in(i)) for i, n in enumerate("xudp"))
        f, h = self.dynamics(x, u, d, p), self.measure(x, p)
        slopes = [*(ca.jacobian(f, v) for v in (x, u, d, p)), ca.jacobian(h, x)]
        return DenseFunction("derivatives", [x, u, d, p], [f, h, *slopes])

    @property
    def address(self) -> str:
        """What a user types to load it again: "laboratory-four-tanks:fitted,volts"."""
        where = str(self.path or self.name)
        where = f"{where}:{','.join(self.variant)}" if self.variant else where
        return f"{where}#{self.drawn}" if self.drawn else where

    def with_parameters(self, values: Mapping[str, float]) -> Process:
        """Return the process with other values of some parameters [SI].

        Examples
        --------
        >>> from clepsydra.process.reader import load_process
        >>> wider = load_process("three-tanks").with_parameters({"tank_1.area": 0.02})
        >>> wider.signal("tank_1.area").initial, wider.signal("tank_2.area").initial
        (0.02, 0.0154)
        """
        changed = tuple(
            replace(each, initial=values.get(each.name, each.initial)) for each in self.parameters
        )
        return replace(self, parameters=changed)

    def place(self, *keys: str) -> str:
        """Return where a key of its file stands, for a message; its name where it has no file."""
        return self.document.place(*keys) if self.document else self.name

    @property
    def file_stem(self) -> str:
        """What files about it are called: "laboratory-four-tanks-fitted-volts"."""
        number = (str(self.drawn),) if self.drawn else ()
        return "-".join((self.name, *self.variant, *number))

    @cached_property
    def levels(self) -> tuple[str, ...]:
        """The states of what holds liquid that are heights, "tank_1.level"."""
        held = {
            state.name for each in self.elements if each.holds_liquid for state in each.states()
        }
        return tuple(each.name for each in self.state if each.name in held and each.unit == "m")

    @property
    def delayed(self) -> tuple[str, ...]:
        """What comes later than its cause: what is in transport delays, and what is told late."""
        return (*(delay.name for delay in self.motion.delays), *self.reporting)

    @property
    def what_delays(self) -> str:
        """What of it holds these back, in words."""
        return "transport delays" if self.motion.delays else "sensors with dead time"

    @property
    def spilt(self) -> dict[str, str]:
        """Element to the total of what it spills, "tank_1" → "tank_1.spilt"; every run has it."""
        return {element.name: element.spilt for element in self.elements if element.spilt}

    @property
    def parameter_values(self) -> np.ndarray:
        """The parameters' values [l], SI."""
        return np.array([parameter.initial for parameter in self.parameters])

    def signal(self, name: str) -> Signal:
        """Return the state, input, disturbance, measurement, parameter, total or memory.

        Raises
        ------
        KeyError
            There is none.
        """
        groups = (self.state, self.inputs, self.disturbances, self.measurements, self.parameters)
        for group in (*groups, self.motion.totals, self.motion.memories):
            for signal in group:
                if signal.name == name:
                    return signal
        raise KeyError(name)
