"""The exact linear model of a process at an operating point."""

from __future__ import annotations

import numpy as np

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.linear.derivatives import Derivatives
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint


def linearise(point: OperatingPoint) -> LinearModel:
    """Return A = ∂f/∂x, B = ∂f/∂u, E = ∂f/∂d and C = ∂h/∂x at the point, D = 0.

    The derivatives are exact (algorithmic differentiation), not differences. The model has all
    inputs, disturbances and measurements; `LinearModel.select` takes some of them.

    Parameters
    ----------
    point : OperatingPoint
        It knows its process.

    Returns
    -------
    LinearModel

    Raises
    ------
    InputError
        A tank is empty at the point, where the outflow has no derivative; or it is no point.

    Examples
    --------
    The two lower tanks of Johansson's process at 3 V have time constants of 62 s and 91 s:

    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> model = linearise(find_equilibrium(load_process("quadruple-tank")))
    >>> (-1.0 / model.A.diagonal()[:2]).round(2)
    array([62.36, 90.63])
    """
    require_type(
        point, OperatingPoint, "point", "an OperatingPoint", "find it with find_equilibrium"
    )
    process = point.process
    for signal, value in zip(process.state, point.state, strict=True):
        if signal.unit == "m" and value <= signal.low:
            raise InputError(
                f"operating point, {signal.name}",
                float(value),
                f"a level above {signal.low:g} m",
                "choose an operating point at which no tank is empty: the outflow of an empty "
                "tank has no derivative",
            )
    local = Derivatives(process).at(point.state, point.inputs, point.disturbances)
    by_cause = (local.rates_by_state, local.rates_by_input, local.rates_by_disturbance)
    for matrix in (*by_cause, local.measured_by_state):
        if not np.all(np.isfinite(matrix)):
            raise InputError(
                f"operating point of {process.name}",
                point.as_dict(),
                "a point at which every equation has a derivative",
                "move the operating point away from limits, floors and reversals of flow",
            )
    A, B, E = by_cause
    C = local.measured_by_state
    return LinearModel(
        A=A,
        B=B,
        E=E,
        C=C,
        D=np.zeros((len(C), B.shape[1])),
        states=tuple(signal.name for signal in process.state),
        inputs=tuple(signal.name for signal in process.inputs),
        disturbances=tuple(signal.name for signal in process.disturbances),
        outputs=tuple(signal.name for signal in process.measurements),
        point=point,
    )


def operating_point_of(model: LinearModel) -> OperatingPoint:
    """Return the operating point that a model was made at, and with it the process.

    Raises
    ------
    InputError
        The model has none, as one that came from python-control; or it is no model.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> operating_point_of(tank)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: linear model, point: got None, expected a model of a process \
at an operating point; make it by linearise(point), or give it its point by dataclasses.replace.
    """
    require_type(
        model, LinearModel, "model", "a LinearModel", "make it with linearise, or by analyse"
    )
    if model.point is None:
        raise InputError(
            "linear model, point",
            None,
            "a model of a process at an operating point",
            "make it by linearise(point), or give it its point by dataclasses.replace",
        )
    return model.point
