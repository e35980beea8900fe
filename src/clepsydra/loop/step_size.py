"""The integration step, from the fastest eigenvalue."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.design.sampling_period import LONGEST_PERIOD, check_sampling_period, fastest_rate
from clepsydra.linear.linear_model import LinearModel

#: Largest |λ| h of an RK4 step. The error of one step is about |λ h|⁵ / 120 of the state's
#: motion: 1e-7 here.
_REACH = 0.1
#: The most RK4 steps in one sampling period.
MOST_SUBSTEPS = round(LONGEST_PERIOD / _REACH)


def substeps_for(model: LinearModel) -> int:
    """Return the number of RK4 steps in a sampling period that the fastest eigenvalue asks for.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs do not count.

    Raises
    ------
    InputError
        The process is sampled so slowly that more than 10,000 steps would be needed
        (`design.sampling_period`), or the model has no operating point.

    Examples
    --------
    The fastest tank has a time constant of 23 s, and the process is sampled each second:

    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> substeps_for(analyse(load_process("quadruple-tank")).model)
    1
    """
    needed = check_sampling_period(model) * fastest_rate(model) / _REACH
    return max(1, math.ceil(needed - 1e-9))


def check_substeps(substeps: int) -> None:
    """Refuse a number of RK4 steps that is none.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_substeps(0)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: substeps: got 0, expected a whole number from 1 to 10000; \
leave it out, and it is chosen from the fastest time constant.
    """
    whole = isinstance(substeps, (int, np.integer)) and not isinstance(substeps, bool)
    if not whole or not 1 <= substeps <= MOST_SUBSTEPS:
        raise InputError(
            "substeps",
            substeps,
            f"a whole number from 1 to {MOST_SUBSTEPS}",
            "leave it out, and it is chosen from the fastest time constant",
        )
