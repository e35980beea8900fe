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


class NotLinearisable(InputError):
    """No state feedback makes the outputs of a process follow new inputs linearly.

    Examples
    --------
    >>> issubclass(NotLinearisable, InputError)
    True
    """


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
class InputAffineEquations:
    """ẋ = f(x) + G(x) u and y = h(x), as expressions.

    Parameters
    ----------
    point : OperatingPoint
    outputs, inputs : tuple of str
    state, moved : casadi.SX [n], [m]
        The symbols of x and u.
    constants : tuple of Constant
    rates : casadi.SX [n]
        f(x) + G(x) u as the process gives it.
    drift, fields : casadi.SX [n], [n, m]
        f and G.
    readings : casadi.SX [q]
        h of the outputs [measurement unit].

    Examples
    --------
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> equations = input_affine_equations(analyse(load_process("quadruple-tank")).model)
    >>> equations.at_point(equations.fields)[0].round(6)  # [m/(s V)]
    array([0.000832, 0.      ])
    """

    point: OperatingPoint
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    state: ca.SX
    moved: ca.SX
    constants: tuple[Constant, ...]
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

    def reading(self, measurement: str) -> ca.SX:
        """Return h of any measurement of the process [measurement unit]."""
        process = self.point.process
        place = [signal.name for signal in process.measurements].index(measurement)
        symbols = {each.signal.name: each.symbol for each in self.constants}
        parameters = ca.vertcat(*(symbols[signal.name] for signal in process.parameters))
        return process.measure(self.state, parameters)[place]

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

    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> input_affine_equations(analyse(load_process("averaging-tank")).model)
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
    at = point.as_dict()
    state, moved = ca.SX.sym("x", len(process.state)), ca.SX.sym("u", len(model.inputs))
    places = {name: place for place, name in enumerate(model.inputs)}
    alone = [signal for signal in process.inputs if signal.name not in places]
    held = [(signal, at[signal.name]) for signal in (*process.disturbances, *alone)]
    held += [(parameter, parameter.initial) for parameter in process.parameters]
    constants = tuple(
        Constant(signal, ca.SX.sym(signal.identifier), value) for signal, value in held
    )
    symbols = {each.signal.name: each.symbol for each in constants}
    symbols |= {name: moved[place] for name, place in places.items()}
    groups = (process.inputs, process.disturbances, process.parameters)
    u, d, p = (ca.vertcat(*(symbols[signal.name] for signal in group)) for group in groups)
    rates = process.dynamics(state, u, d, p)
    drift, fields = _solved(rates, moved, point, model.inputs)
    readings = process.measure(state, p)
    known = [signal.name for signal in process.measurements]
    return InputAffineEquations(
        point=point,
        outputs=model.outputs,
        inputs=model.inputs,
        state=state,
        moved=moved,
        constants=constants,
        rates=rates,
        drift=drift,
        fields=fields,
        readings=ca.vertcat(*(readings[known.index(name)] for name in model.outputs)),
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
