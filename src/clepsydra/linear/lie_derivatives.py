"""Lie derivatives of a process whose inputs act linearly: ẋ = f(x) + G(x) u, y = h(x)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.linear.process_equations import ProcessEquations, process_equations


class NotLinearisable(InputError):
    """No state feedback makes the outputs of a process follow new inputs linearly."""


@dataclass(frozen=True, eq=False)
class InputAffineEquations(ProcessEquations):
    """ẋ = f(x) + G(x) u and y = h(x), of every state.

    Parameters
    ----------
    drift, fields : casadi.SX [n], [n, m]
        f and G.

    Examples
    --------
    >>> import clepsydra as cl
    >>> equations = input_affine_equations(cl.load("quadruple-tank").linear)
    >>> equations.at(equations.fields)[0].round(6)  # [m/(s V)]
    array([0.000832, 0.      ])
    """

    drift: ca.SX
    fields: ca.SX


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
    if process.delayed:
        got = ", ".join(process.delayed)
        expected = "a process without dead time: no feedback undoes what comes later"
        remedy = "control it by a method that holds for dead time"
        raise NotLinearisable(f"{process.name}, {process.what_delays}", got, expected, remedy)
    whole = process_equations(model, every_state=True)
    drift, fields = _solved(whole.rates, whole.moved, point, model.inputs)
    return InputAffineEquations(**vars(whole), drift=drift, fields=fields)


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
        got = ", ".join(inputs[column] for column in curved)
        expected = "inputs that act linearly, each alone"
        remedy = "control them by another method, or leave all but one of them alone"
        raise NotLinearisable(f"{point.process.name}, inputs", got, expected, remedy)
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
