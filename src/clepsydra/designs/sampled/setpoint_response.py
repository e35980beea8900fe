"""How long the linear sampled loop takes to settle after a setpoint step."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.designs.sampled.sampled_loop import SampledLoops
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: The error is followed until the slowest mode has shrunk to this share.
_GONE = 1e-6
#: The response is looked at in so many instants.
_INSTANTS = 4000
_ROUNDING = 1e-10


def settling_times(
    controller: Controller, model: LinearModel, band: float = 0.02
) -> dict[str, float]:
    """Return how long each controlled measurement takes to settle after its own setpoint step.

    Of the linear model, held over each sample, under the derivatives of the law: as designed,
    without limits.

    Parameters
    ----------
    band : float
        Share of the step.

    Returns
    -------
    dict
        Controlled measurement to a time [s]; infinite where the loop is unstable or the
        measurement never comes to its setpoint.

    Raises
    ------
    InputError, NotApplicable
        As `designs.sampled.sampled_loop.sampled_loop`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> times = settling_times(cl.design.simc(plant), plant.linear)
    >>> round(times["level_1"])
    48
    """
    A, B, C = SampledLoops(controller, model).from_setpoints(controller.values)
    period = operating_point_of(model).process.sampling_period
    controlled = list(dict.fromkeys(controller.setpoints))
    return {
        name: settled_after(A, B[:, column], C[controlled.index(name)], period, band)
        for column, name in enumerate(controller.setpoints)
    }


def settled_after(
    A: np.ndarray, b: np.ndarray, c: np.ndarray, period: float, band: float = 0.02
) -> float:
    """Return how long c x of x(k+1) = A x + b takes from rest to stay within a band around 1.

    Parameters
    ----------
    A, b, c : ndarray [n, n], [n], [n]
    period : float
        [s]

    Returns
    -------
    float
        [s]; infinite where it is unstable or ends outside the band.

    Examples
    --------
    x⁺ = 0.5 x + 0.5 is nearer to 1 than 2 % after six samples:

    >>> one = np.ones(1)
    >>> settled_after(0.5 * np.eye(1), 0.5 * one, one, 1.0)
    6.0
    """
    slowest = float(np.max(np.abs(np.linalg.eigvals(A)), initial=0.0))
    if slowest >= 1.0 - _ROUNDING:
        return math.inf
    at_rest = np.linalg.solve(np.eye(len(A)) - A, b)
    offset = float(c @ at_rest) - 1.0
    if abs(offset) > band:
        return math.inf
    samples = max(1, math.ceil(math.log(_GONE) / math.log(max(slowest, _GONE))))
    stride = math.ceil(samples / _INSTANTS)
    jump = np.linalg.matrix_power(A, stride)
    deviation, last = -at_rest, 0
    for instant in range(1, math.ceil(samples / stride) + 1):
        deviation = jump @ deviation
        if abs(c @ deviation + offset) > band:
            last = instant
    return (last + 1) * stride * period
