"""The step response of a linear model, exact, also with dead time."""

from __future__ import annotations

from fractions import Fraction
from math import gcd, lcm

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebpts2, chebvander
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import InternalDelays, LinearModel

# Polynomials of this degree, on intervals shorter than the fastest time constant.
_DEGREE = 12
_MOST_INTERVALS = 100_000
# A dead time is taken for a fraction whose denominator is not above this.
_DENOMINATOR = 10_000


def step_response(model: LinearModel, times: ArrayLike) -> np.ndarray:
    """Return what each output does after a step of one in each manipulated input, from rest.

    Without dead time the motion between two times is the matrix exponential. With dead time the
    axis is cut into intervals of which every dead time is a multiple, so that what comes back in
    one is what left in an earlier one (the method of steps), as a polynomial of degree 12 on
    each: errors are near rounding, and jumps stand where they belong.

    Parameters
    ----------
    times : array_like [l]
        Not falling, from zero on [s]. At a jump, the value after it.

    Returns
    -------
    ndarray [l, q, m]
        [output unit / input unit]

    Raises
    ------
    InputError
        The times fall or are negative; or the dead times have no common measure long enough.

    References
    ----------
    R. Bellman and K. L. Cooke, Differential-Difference Equations, 1963, chapter 3.

    Examples
    --------
    A tank with gain 2 and time constant 50 s after one time constant, 2 (1 - 1/e):

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> step_response(tank, [0.0, 50.0])[:, 0, 0].round(6)
    array([0.      , 1.264241])
    """
    moments = np.atleast_1d(np.asarray(times, float))
    if not np.all(np.isfinite(moments)) or np.any(np.diff(moments, prepend=0.0) < 0.0):
        raise InputError(
            "step response, times", moments.tolist(), "times from 0 s on, not falling", "sort them"
        )
    if model.delays is None:
        return _by_matrix_exponential(model, moments)
    return _by_steps(model, model.delays, moments)


def _by_matrix_exponential(model: LinearModel, moments: np.ndarray) -> np.ndarray:
    from scipy.linalg import expm

    n, m = model.B.shape
    moving = np.block([[model.A, model.B], [np.zeros((m, n + m))]])
    known: dict[float, np.ndarray] = {}
    motion, last = np.vstack([np.zeros((n, m)), np.eye(m)]), 0.0
    values = np.empty((len(moments), len(model.outputs), m))
    for place, moment in enumerate(moments):
        # Steps that differ by rounding of an even grid are one step.
        step = float(f"{moment - last:.12e}")
        if step > 0.0:
            if step not in known:
                known[step] = expm(moving * step)
            motion = known[step] @ motion
        last = moment
        values[place] = model.C @ motion[:n] + model.D
    return values


def _by_steps(model: LinearModel, delays: InternalDelays, moments: np.ndarray) -> np.ndarray:
    n, m = model.B.shape
    r = len(delays.times)
    length, behind = _intervals(model, delays)
    last = float(moments.max(initial=0.0))
    count = int(np.floor(last / length * (1.0 + 1e-12))) + 1
    if count > _MOST_INTERVALS:
        raise _incommensurable(
            delays, f"a common measure longer than {last / _MOST_INTERVALS:.3g} s"
        )
    # On each interval: ẋ = A x + B u + to_states z at all nodes but the first, where x goes on.
    nodes = chebpts2(_DEGREE + 1)
    fitted = np.linalg.inv(chebvander(nodes, _DEGREE))  # coefficients of values at the nodes
    slopes = chebvander(nodes, _DEGREE - 1) @ chebder(fitted) * 2.0 / length
    size = len(nodes)
    matrix = np.kron(slopes, np.eye(n)) - np.kron(np.eye(size), model.A)
    matrix[:n] = np.eye(n, size * n)
    inverse = np.linalg.inv(matrix)
    left = np.zeros((count, size, r, m))  # w at the nodes of each interval
    values = np.empty((len(moments), len(model.outputs), m))
    interval_of = np.minimum((moments / length * (1.0 + 1e-12)).astype(int), count - 1)
    state = np.zeros((n, m))
    for interval in range(count):
        back = np.zeros((size, r, m))  # z; before the step nothing left
        for signal, steps in enumerate(behind):
            if interval >= steps:
                back[:, signal] = left[interval - steps, :, signal]
        driven = model.B + delays.to_states @ back
        driven[0] = state
        states = (inverse @ driven.reshape(size * n, m)).reshape(size, n, m)
        left[interval] = delays.from_states @ states + delays.from_inputs + delays.through @ back
        state = states[-1]
        wanted = np.flatnonzero(interval_of == interval)
        if len(wanted):
            outputs = model.C @ states + model.D + delays.to_outputs @ back
            local = np.clip(2.0 * (moments[wanted] / length - interval) - 1.0, -1.0, 1.0)
            values[wanted] = np.tensordot(chebvander(local, _DEGREE) @ fitted, outputs, axes=1)
    return values


def _intervals(model: LinearModel, delays: InternalDelays) -> tuple[float, list[int]]:
    """Return the length of the intervals [s], and how many of them each dead time is."""
    unit = float(delays.times.max())
    parts = [Fraction(time / unit).limit_denominator(_DENOMINATOR) for time in delays.times]
    if max(abs(part * unit - time) for part, time in zip(parts, delays.times, strict=True)) > (
        1e-12 * unit
    ):
        raise _incommensurable(delays, "dead times with a common measure")
    shares = lcm(*(part.denominator for part in parts))
    whole = [part.numerator * (shares // part.denominator) for part in parts]
    common = gcd(*whole)
    measure = unit * common / shares
    # The largest eigenvalue of |A| bounds its rates in whatever units the states are.
    fastest = float(np.abs(np.linalg.eigvals(np.abs(model.A))).max(initial=0.0))
    splits = max(1, int(np.ceil(measure * fastest)))
    return measure / splits, [number // common * splits for number in whole]


def _incommensurable(delays: InternalDelays, expected: str) -> InputError:
    return InputError(
        "step response, delays",
        f"dead times of {', '.join(f'{time:.9g}' for time in delays.times)} s",
        expected,
        "round the dead times, or approximate them by "
        "clepsydra.linear.dead_time.without_dead_time(model, order)",
    )
