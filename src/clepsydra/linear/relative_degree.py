"""The vector relative degree of a process, and its decoupling matrix."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from clepsydra.linear.lie_derivatives import (
    InputAffineEquations,
    NotLinearisable,
    input_affine_equations,
    lie_derivative,
)
from clepsydra.linear.linear_model import LinearModel, refuse_delays
from clepsydra.linear.linearise import operating_point_of

#: A higher derivative is beyond what measurements and a model bear.
MOST_DERIVATIVES = 4
#: An entry this small beside the terms that it is the sum of is rounding.
_ROUNDING = 1e-11
#: A decoupling matrix whose scaled singular values differ more is singular.
_SINGULAR = 1e-9


@dataclass(frozen=True, eq=False)
class VectorRelativeDegree:
    """d^r y/dt^r = L(x) + E(x) u: how often each output is differentiated until an input shows.

    Parameters
    ----------
    degrees : tuple of int [q]
        r of each output.
    derivatives : tuple of tuple of casadi.SX
        For each output h, L_f h, …, L_f^r h; the last is its entry of L.
    decoupling : casadi.SX [q, m]
        E.
    order : tuple of (int, int)
        Places of output and input, paired so that elimination in this order divides by no zero
        at the operating point, the largest first.
    """

    equations: InputAffineEquations
    degrees: tuple[int, ...]
    derivatives: tuple[tuple[ca.SX, ...], ...]
    decoupling: ca.SX
    order: tuple[tuple[int, int], ...]

    @property
    def at_point(self) -> np.ndarray:
        """E at the operating point [q, m]."""
        return self.equations.at(self.decoupling)

    @property
    def drift(self) -> ca.SX:
        """L [q]."""
        return ca.vertcat(*(each[-1] for each in self.derivatives))


def relative_degree(model: LinearModel) -> VectorRelativeDegree:
    """Differentiate each output along the equations until an input shows.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point, with as many outputs as inputs.

    Raises
    ------
    InputError
        The model has no operating point.
    NotLinearisable
        The equations are not linear in the inputs, there are more inputs than outputs or fewer,
        no input moves an output or only after more than four differentiations, or the decoupling
        matrix is singular.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, section 5.1,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    The last of three tanks answers to the feed of the first through two others:

    >>> import clepsydra as cl
    >>> relative_degree(cl.load("three-tanks").linear).degrees
    (3,)
    """
    process = operating_point_of(model).process
    if len(model.outputs) != len(model.inputs):
        where = f"{process.name}, outputs"
        expected = f"as many as there are inputs: {', '.join(model.inputs)}"
        remedy = "choose other outputs, or leave an input alone"
        raise NotLinearisable(where, ", ".join(model.outputs), expected, remedy)
    equations = input_affine_equations(model)
    degrees = linear_relative_degrees(model)
    derivatives, rows = [], []
    for place, degree in enumerate(degrees):
        chain = [equations.reading(model.outputs[place])]
        for _ in range(degree):
            shown = lie_derivative(chain[-1], equations.fields, equations.state)
            chain.append(lie_derivative(chain[-1], equations.drift, equations.state))
        derivatives.append(tuple(chain))
        rows.append(ca.densify(shown))
    decoupling = ca.vertcat(*rows)
    return VectorRelativeDegree(
        equations,
        degrees,
        tuple(derivatives),
        decoupling,
        elimination_order(equations.at(decoupling), model),
    )


def linear_relative_degrees(model: LinearModel) -> tuple[int, ...]:
    """Return for each output the smallest r with C A^(r−1) B ≠ 0.

    At a point of rest it is the relative degree of the nonlinear process too, since a constant
    input does not change it.

    Parameters
    ----------
    model : LinearModel
        Of a process, without dead time.

    Raises
    ------
    NotLinearisable
        No input moves an output, or only after more than four differentiations.
    """
    refuse_delays(model.delays, "a relative degree")
    found = []
    for name, row in zip(model.outputs, model.C, strict=True):
        size, degree = np.abs(row), 1
        while degree <= len(model.states):
            if np.any(np.abs(row @ model.B) > _ROUNDING * (size @ np.abs(model.B))):
                break
            row, size, degree = row @ model.A, size @ np.abs(model.A), degree + 1
        if degree > len(model.states):
            expected = "an input that moves it"
            remedy = "control another output, or add an input"
            raise NotLinearisable(f"{name}, relative degree", "none", expected, remedy)
        if degree > MOST_DERIVATIVES:
            expected = f"at most {MOST_DERIVATIVES} differentiations until an input shows"
            remedy = "control an output nearer to the input, or by another method"
            raise NotLinearisable(f"{name}, relative degree", degree, expected, remedy)
        found.append(degree)
    return tuple(found)


def elimination_order(matrix: np.ndarray, model: LinearModel) -> tuple[tuple[int, int], ...]:
    """Return rows and columns in the order of complete pivoting.

    Raises
    ------
    NotLinearisable
        The matrix is singular, as near as matters.
    """
    process = operating_point_of(model).process
    spans = np.array([process.signal(name).span for name in model.inputs])
    left = matrix * np.where(np.isfinite(spans), spans, 1.0)
    lengths = np.linalg.norm(left, axis=1)
    left = left / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    if np.linalg.svd(left, compute_uv=False)[-1] < _SINGULAR:
        raise NotLinearisable(
            f"{process.name}, outputs",
            ", ".join(model.outputs),
            "outputs whose first answers to the inputs differ: the decoupling matrix is singular",
            "control other outputs",
        )
    rows, columns, order = list(range(len(left))), list(range(len(left))), []
    while rows:
        sizes = np.abs(left[np.ix_(rows, columns)])
        # Of equal pivots the first: the order of the file.
        row, column = np.unravel_index(int(np.argmax(sizes > 0.999 * sizes.max())), sizes.shape)
        j, i = rows.pop(int(row)), columns.pop(int(column))
        order.append((j, i))
        for other in rows:
            left[other] = left[other] - left[j] * (left[other, i] / left[j, i])
    return tuple(order)
