"""Symbols for the equations of a process: what is moved, and what stays as it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.linear.operating_point import OperatingPoint


@dataclass(frozen=True, eq=False)
class Constant:
    """What the equations take as constant: a parameter, a disturbance, an input left alone.

    Parameters
    ----------
    signal : Signal
    symbol : casadi.SX
        It stands for it in the equations.
    value : float
        At the operating point [signal unit].

    Examples
    --------
    >>> Constant(Signal("tank.area", "m^2"), ca.SX.sym("a"), 0.0028).value
    0.0028
    """

    signal: Signal
    symbol: ca.SX
    value: float


@dataclass(frozen=True, eq=False)
class ProcessSymbols:
    """The symbols of the inputs that are moved, and of all that is constant.

    Parameters
    ----------
    point : OperatingPoint
    inputs : tuple of str
        Those that are moved.
    moved : casadi.SX [m]
        Their symbols.
    constants : tuple of Constant
        The other inputs, disturbances and parameters.

    Examples
    --------
    See `process_symbols`.
    """

    point: OperatingPoint
    inputs: tuple[str, ...]
    moved: ca.SX
    constants: tuple[Constant, ...]

    def rates(self, state: ca.SX) -> ca.SX:
        """Return dx/dt in a state [n]."""
        process = self.point.process
        symbols = {each.signal.name: each.symbol for each in self.constants}
        symbols |= dict(zip(self.inputs, ca.vertsplit(self.moved), strict=True))
        groups = (process.inputs, process.disturbances, process.parameters)
        given = (ca.vertcat(*(symbols[signal.name] for signal in group)) for group in groups)
        return process.dynamics(state, *given)

    def readings(self, state: ca.SX, measurements: Sequence[str]) -> ca.SX:
        """Return what some sensors of the process show in a state [measurement unit]."""
        process = self.point.process
        symbols = {each.signal.name: each.symbol for each in self.constants}
        parameters = ca.vertcat(*(symbols[signal.name] for signal in process.parameters))
        known = [signal.name for signal in process.measurements]
        shown = process.measure(state, parameters)
        return ca.vertcat(*(shown[known.index(name)] for name in measurements))


def process_symbols(point: OperatingPoint, inputs: tuple[str, ...]) -> ProcessSymbols:
    """Return symbols for the equations of a process of which some inputs are moved.

    Parameters
    ----------
    point : OperatingPoint
    inputs : tuple of str

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> found = process_symbols(find_equilibrium(load_process("quadruple-tank")), ("pump_1",))
    >>> [each.signal.name for each in found.constants if each.signal.name.startswith("pump")][0]
    'pump_2'
    """
    process, at = point.process, point.as_dict()
    alone = [signal for signal in process.inputs if signal.name not in inputs]
    held = [(signal, at[signal.name]) for signal in (*process.disturbances, *alone)]
    held += [(parameter, parameter.initial) for parameter in process.parameters]
    constants = tuple(
        Constant(signal, ca.SX.sym(signal.identifier), value) for signal, value in held
    )
    return ProcessSymbols(point, inputs, ca.SX.sym("u", len(inputs)), constants)
