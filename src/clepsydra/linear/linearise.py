"""The exact linear model of a process at an operating point."""

from __future__ import annotations

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.derivatives import Derivatives
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process


def linearise(process: Process, point: OperatingPoint) -> LinearModel:
    """Return A = ∂f/∂x, B = ∂f/∂u, E = ∂f/∂d and C = ∂h/∂x at the point, D = 0.

    The derivatives are exact (algorithmic differentiation), not differences. The model has all
    inputs, disturbances and measurements; `LinearModel.select` takes some of them.

    Parameters
    ----------
    process : Process
    point : OperatingPoint

    Returns
    -------
    LinearModel

    Raises
    ------
    InputError
        A tank is empty at the point, where the outflow has no derivative.

    Examples
    --------
    The two lower tanks of Johansson's process at 3 V have time constants of 62 s and 91 s:

    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> model = linearise(process, find_equilibrium(process))
    >>> (-1.0 / model.A.diagonal()[:2]).round(2)
    array([62.36, 90.63])
    """
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
