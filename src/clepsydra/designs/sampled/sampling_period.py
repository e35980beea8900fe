"""The longest sampling period that a controller is designed and simulated for."""

from __future__ import annotations

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of

#: The longest sampling period, in times of the fastest time constant.
LONGEST_PERIOD = 1000.0


def fastest_rate(model: LinearModel) -> float:
    """Return the magnitude of the fastest eigenvalue [rad/s], the inverse of a time constant.

    Examples
    --------
    >>> one = np.eye(1)
    >>> fastest_rate(LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                          ("tank.level",), ("pump",), (), ("level",)))
    0.02
    """
    return float(np.max(np.abs(np.linalg.eigvals(model.A)), initial=0.0))


def check_sampling_period(model: LinearModel) -> float:
    """Return the sampling period of a model's process [s].

    Raises
    ------
    InputError
        It is longer than a thousand times the fastest time constant, or the model has no
        operating point.

    Examples
    --------
    >>> import clepsydra as cl
    >>> check_sampling_period(cl.load("quadruple-tank").linear)
    1.0
    """
    process, rate = operating_point_of(model).process, fastest_rate(model)
    period = process.sampling_period
    if rate * period > LONGEST_PERIOD:
        raise InputError(
            f"{process.name}, sampling_period",
            f"{period:g} s",
            f"at most {LONGEST_PERIOD / rate:.3g} s, {LONGEST_PERIOD:g} times the fastest time "
            f"constant of {1.0 / rate:.3g} s",
            "shorten the sampling period",
        )
    return period
