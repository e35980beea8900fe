"""Lie derivatives of a process whose inputs act linearly: ẋ = f(x) + G(x) u, y = h(x)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.process_symbols import Constant, ProcessSymbols, process_symbols


class NotLinearisable(InputError):
    """No state feedback makes the outputs of a process follow new inputs linearly.

    Examples
    --------
    >>> issubclass(NotLinearisable, InputError)
    True
    """


@dataclass(frozen=True, eq=False)
class InputAffineEquations:
    """ẋ = f(x) + G(x) u and y = h(x), as expressions.

    Parameters
    ----------
    symbols : ProcessSymbols
        Of u and what is constant.
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

    symbols: ProcessSymbols
    outputs: tuple[str, ...]
    state: ca.SX
    rates: ca.SX
    drift: ca.SX
    fields: ca.SX
    readings: ca.SX

    @property
    def point(self) -> OperatingPoint:
        """Of the process."""
        return self.symbols.point

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs that are moved."""
        return self.symbols.inputs

    @property
    def moved(self) -> ca.SX:
        """The symbols of u [m]."""
        return self.symbols.moved

    @property
    def constants(self) -> tuple[Constant, ...]:
        """What else the equations depend on."""
        return self.symbols.constants

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return tuple(signal.name for signal in self.point.process.state)

    @cached_property
    def _symbols(self) -> list[ca.SX]:
        return [self.state, self.moved, ca.vertcat(*(each.symbol for each in self.constants))]

    def reading(self, measurement: str) -> ca.SX:
        """Return h of any measurement of the process [measurement unit]."""
        return self.symbols.readings(self.state, [measurement])

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
    rates = symbols.rates(state)
    drift, fields = _solved(rates, symbols.moved, point, model.inputs)
    return InputAffineEquations(
        symbols=symbols,
        outputs=model.outputs,
        state=state,
        rates=rates,
        drift=drift,
        fields=fields,
        readings=symbols.readings(state, model.outputs),
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
