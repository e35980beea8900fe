"""Lie derivatives of a process whose inputs act linearly: ẋ = f(x) + G(x) u, y = h(x)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
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

    def rates_in(self, state: ca.SX) -> ca.SX:
        """Return dx/dt in a state [n]."""
        process = self.point.process
        symbols = {each.signal.name: each.symbol for each in self.constants}
        symbols |= dict(zip(self.inputs, ca.vertsplit(self.moved), strict=True))
        groups = (process.inputs, process.disturbances, process.parameters)
        given = (ca.vertcat(*(symbols[signal.name] for signal in group)) for group in groups)
        return process.dynamics(state, *given)

    def readings_in(self, state: ca.SX, measurements: Sequence[str]) -> ca.SX:
        """Return what some sensors of the process show in a state [measurement unit]."""
        process = self.point.process
        symbols = {each.signal.name: each.symbol for each in self.constants}
        parameters = ca.vertcat(*(symbols[signal.name] for signal in process.parameters))
        known = [signal.name for signal in process.measurements]
        shown = process.measure(state, parameters)
        return ca.vertcat(*(shown[known.index(name)] for name in measurements))


def process_symbols(point: OperatingPoint, inputs: tuple[str, ...]) -> ProcessSymbols:
    """Return symbols for the equations of a process of which some inputs are moved.

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


class NotLinearisable(InputError):
    """No state feedback makes the outputs of a process follow new inputs linearly.

    Examples
    --------
    >>> issubclass(NotLinearisable, InputError)
    True
    """


@dataclass(frozen=True, eq=False)
class InputAffineEquations(ProcessSymbols):
    """ẋ = f(x) + G(x) u and y = h(x), as expressions.

    Parameters
    ----------
    point, inputs, moved, constants
        As in `ProcessSymbols`.
    outputs : tuple of str
    state : casadi.SX [n]
        The symbol of x.
    rates : casadi.SX [n]
        f(x) + G(x) u as the process gives it.
    drift, fields : casadi.SX [n], [n, m]
        f and G.
    readings : casadi.SX [q]
        h of the outputs [measurement unit].

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = input_affine_equations(cl.load("quadruple-tank").linear)
    >>> equations.at_point(equations.fields)[0].round(6)  # [m/(s V)]
    array([0.000832, 0.      ])
    """

    outputs: tuple[str, ...]
    state: ca.SX
    rates: ca.SX
    drift: ca.SX
    fields: ca.SX
    readings: ca.SX

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(signal.name for signal in self.point.process.state)

    @cached_property
    def _symbols(self) -> list[ca.SX]:
        return [self.state, self.moved, ca.vertcat(*(each.symbol for each in self.constants))]

    def acting_on(self, names: Sequence[str]) -> list[str]:
        """Return some states, and those that act on them, at once or through further ones."""
        found = list(names)
        for name in found:
            rate = self.rates[self.states.index(name)]
            for place, other in enumerate(self.states):
                if other not in found and ca.depends_on(rate, self.state[place]):
                    found.append(other)
        return found

    def reading(self, measurement: str) -> ca.SX:
        """Return h of any measurement of the process [measurement unit]."""
        return self.readings_in(self.state, [measurement])

    def at_point(self, expression: ca.SX) -> np.ndarray:
        """Return the value of an expression at the operating point."""
        return self.at(expression, self.point.state)

    def at(
        self, expression: ca.SX, state: np.ndarray, moved: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the value of an expression in a state.

        Parameters
        ----------
        expression : casadi.SX
        state : ndarray [n]
        moved : ndarray [m], optional
            u; that of the operating point if left out.
        """
        at = self.point.as_dict()
        inputs = [at[name] for name in self.inputs] if moved is None else moved
        constants = [each.value for each in self.constants]
        function = ca.Function("value", self._symbols, [ca.densify(expression)])
        return np.array(function(state, inputs, constants), float)


def input_affine_equations(model: LinearModel) -> InputAffineEquations:
    """Return the equations of a process, solved for how its inputs act.

    Where an input acts in pieces, a pump with a dead band say, it is the piece that the
    operating point lies in. Switches stand as at first.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point: it says which outputs and inputs are meant.

    Raises
    ------
    InputError
        The model has no operating point.
    NotLinearisable
        The process has dead time, or an input acts other than linearly.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, chapter 5,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    The averaging tank takes the product of a flow and its concentration, both manipulated:

    >>> import clepsydra as cl
    >>> input_affine_equations(cl.load("averaging-tank").linear)
    Traceback (most recent call last):
        ...
    clepsydra.linear.lie_derivatives.NotLinearisable: averaging-tank, inputs: got 'inflow, \
inflow.impurity', expected inputs that act linearly, each alone; control them by another method, \
or leave all but one of them alone.
    """
    point = operating_point_of(model)
    process = point.process
    if process.motion.delays:
        raise NotLinearisable(
            f"{process.name}, transport delays",
            ", ".join(delay.name for delay in process.motion.delays),
            "a process without dead time: no feedback undoes what comes later",
            "control it by a method that holds for dead time",
        )
    symbols = process_symbols(point, model.inputs)
    state = ca.SX.sym("x", len(process.state))
    rates = symbols.rates_in(state)
    drift, fields = _solved(rates, symbols.moved, point, model.inputs)
    return InputAffineEquations(
        **vars(symbols),
        outputs=model.outputs,
        state=state,
        rates=rates,
        drift=drift,
        fields=fields,
        readings=symbols.readings_in(state, model.outputs),
    )


def _solved(
    rates: ca.SX, moved: ca.SX, point: OperatingPoint, inputs: Sequence[str]
) -> tuple[ca.SX, ca.SX]:
    """Return f and G of ẋ = f + G u."""
    fields = ca.jacobian(rates, moved)
    if not ca.depends_on(fields, moved):
        return ca.substitute(rates, moved, ca.SX.zeros(moved.numel())), fields
    bent = ca.sparsify(ca.jacobian(ca.vec(ca.densify(fields)), moved))
    if bent.nnz():
        curved = sorted({column for _, column in zip(*bent.sparsity().get_triplet(), strict=True)})
        raise NotLinearisable(
            f"{point.process.name}, inputs",
            ", ".join(inputs[column] for column in curved),
            "inputs that act linearly, each alone",
            "control them by another method, or leave all but one of them alone",
        )
    at = point.as_dict()
    here = ca.SX([at[name] for name in inputs])
    piece = ca.substitute(fields, moved, here)
    return ca.substitute(rates, moved, here) - piece @ here, piece


def lie_derivative(scalar: ca.SX, field: ca.SX, state: ca.SX) -> ca.SX:
    """Return L_f h = ∂h/∂x f: how fast h changes along a vector field.

    Parameters
    ----------
    scalar : casadi.SX
        h(x)
    field : casadi.SX [n] or [n, m]
        f(x), or several fields side by side.
    state : casadi.SX [n]
        x

    Returns
    -------
    casadi.SX [1] or [1, m]

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, section 1.2,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    Along ẋ = −x² the square of x changes by −2 x³:

    >>> x = ca.SX.sym("x")
    >>> float(ca.Function("f", [x], [lie_derivative(x**2, -(x**2), x)])(3.0))
    -54.0
    """
    return ca.jacobian(scalar, state) @ field
