"""The integration step, from the fastest eigenvalue."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.sampled.sampling_period import LONGEST_PERIOD, check_sampling_period
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.process.hybrid import Delay
from clepsydra.process.process import Process

#: Largest |λ| h of an RK4 step. The error of one step is about |λ h|⁵ / 120 of the state's
#: motion: 1e-7 here.
_REACH = 0.1
#: The same for the lag of an instrument that has settled long before the next sample.
_LAG_REACH = 1.0
#: Such a lag settles this many times in a sampling period: what is left of it is e⁻²⁰.
_SETTLED = 20.0
#: The most RK4 steps in one sampling period.
MOST_SUBSTEPS = round(LONGEST_PERIOD / _REACH)


def substeps_for(model: LinearModel) -> int:
    """Return the number of RK4 steps in a sampling period that the fastest eigenvalue asks for.

    A step is a tenth of the fastest time constant. The lags of actuators and sensors that settle
    twenty times in a sampling period do not ask for so much: what drives them is held, so that
    at the next sample they stand where they settle, which no step length changes, and the
    integral over their way there is exact for any step of RK4, as it keeps linear integrals of
    the motion. They get a step as long as their time constant, well within the method's reach
    of 2.79.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point; its outputs do not count.

    Raises
    ------
    InputError
        The process is sampled so slowly that more than 10,000 steps would be needed
        (`designs.sampled.sampling_period`), or the model has no operating point.

    Examples
    --------
    The fastest tank has a time constant of 23 s, and the process is sampled each second:

    >>> import clepsydra as cl
    >>> substeps_for(cl.load("quadruple-tank").linear)
    1
    """
    period = check_sampling_period(model)
    settled = _settled_lags(model, period)
    others = np.delete(np.delete(model.A, settled, axis=0), settled, axis=1)
    fastest = float(np.max(np.abs(np.linalg.eigvals(others)), initial=0.0))
    lag = float(np.max(np.abs(np.diag(model.A)[settled]), initial=0.0))
    needed = period * max(fastest / _REACH, lag / _LAG_REACH)
    multiple = delay_substeps(operating_point_of(model).process)
    return multiple * max(1, math.ceil(needed / multiple - 1e-9))


def _settled_lags(model: LinearModel, period: float) -> list[int]:
    """Return which states are lags of instruments that settle long before the next sample.

    A lag depends on no other state, as an actuator's, or no other depends on it, as a sensor's.
    Its entry on the diagonal then is an eigenvalue, and the others are those of what remains.
    """
    elements = operating_point_of(model).process.elements
    tanks = {s.name for e in elements if e.symbol == "tank" for s in e.states()}
    own = {s.name for e in elements for s in e.states()} - tanks
    coupled = model.A != 0.0
    np.fill_diagonal(coupled, False)
    alone = ~coupled.any(axis=1) | ~coupled.any(axis=0)
    quick = -np.diag(model.A) * period >= _SETTLED
    return [i for i, name in enumerate(model.states) if name in own and alone[i] and quick[i]]


def delay_substeps(process: Process) -> int:
    """Return the smallest number of steps in a sampling period that every delay is a multiple of.

    A jump that enters a delay then leaves it between two steps, and nothing is interpolated.

    Raises
    ------
    InputError
        There is none up to 10,000.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> delay_substeps(load_process("quadruple-tank"))
    1
    """
    steps = 1
    for delay in process.motion.delays:
        periods = delay.time / process.sampling_period
        ratio = Fraction(periods).limit_denominator(MOST_SUBSTEPS)
        if ratio == 0 or abs(ratio / Fraction(periods) - 1) > 1e-9:
            raise _no_multiple(process, delay)
        steps = math.lcm(steps, ratio.denominator)
        if steps > MOST_SUBSTEPS:
            raise _no_multiple(process, delay)
    return steps


def _no_multiple(process: Process, delay: Delay) -> InputError:
    shortest = process.sampling_period / MOST_SUBSTEPS
    return InputError(
        f"{process.name}, {delay.name}, time",
        f"{delay.time:g} s",
        f"a multiple of an integration step of at least {shortest:g} s, which is a whole part of "
        f"the sampling period of {process.sampling_period:g} s",
        "round the delay or change the sampling period",
    )


def check_substeps(substeps: int, process: Process | None = None) -> None:
    """Refuse a number of RK4 steps that is none, or that no delay of a process fits.

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
    multiple = delay_substeps(process) if process is not None else 1
    if substeps % multiple:
        raise InputError(
            "substeps",
            substeps,
            f"a multiple of {multiple}, so that every delay is a whole number of steps",
            "leave it out, and it is chosen from the fastest time constant and the delays",
        )
