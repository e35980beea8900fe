"""How fast a loop between an input and an output can be expected to act, before it is designed."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.linear.control_authority import DESIGN_STEP, control_authority
from clepsydra.linear.dead_time import dead_times
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.ranges import in_known_ranges
from clepsydra.linear.response import frequency_response

# Frequencies searched below the fastest that sampling allows.
_DECADES = 9
_A_DECADE = 20


def expected_crossovers(model: LinearModel) -> np.ndarray | None:
    """Return for each pair how fast a loop between them can act [rad/s]; None without ranges.

    It is where the gain of the pair falls below one when a setpoint step of a tenth of the
    output's range uses up the room of the input, and no more than one over the dead time of the
    pair and half a sampling period: faster the input cannot, and need not, act.

    Parameters
    ----------
    model : LinearModel
        Of a process at an operating point.

    Returns
    -------
    ndarray [q, m] or None
        Zero where the input has no such gain at any frequency.

    Examples
    --------
    The pump stands at 3 V of 10 V; of a step of 1 V in level its lag of 62 s leaves 0.12 rad/s:

    >>> import clepsydra as cl
    >>> model = cl.load("quadruple-tank").analysis.model
    >>> round(float(expected_crossovers(model)[0, 0]), 2)
    0.12
    """
    shares = in_known_ranges(model)
    if shares is None or model.point is None:
        return None
    process, at = model.point.process, model.point.as_dict()
    signals = [process.signal(name) for name in model.inputs]
    room = np.array([control_authority(each, at[each.name]) / each.span for each in signals])
    late = np.nan_to_num(dead_times(model), nan=float(model.times.sum()))
    fastest = 1.0 / (late + process.sampling_period / 2.0)
    omegas = float(fastest.max()) * np.logspace(-_DECADES, 0.0, _DECADES * _A_DECADE + 1)
    gains = np.abs(frequency_response(shares, omegas)) * room / DESIGN_STEP
    found = np.zeros(gains.shape[1:])
    for pair in np.ndindex(*found.shape):
        found[pair] = _last_above_one(omegas, gains[:, *pair])
    return np.minimum(found, fastest)


def _last_above_one(omegas: np.ndarray, gains: np.ndarray) -> float:
    """Return the highest frequency at which a gain is one, along straight lines in a Bode plot."""
    above = np.flatnonzero(gains >= 1.0)
    if not above.size:
        return 0.0
    last = int(above[-1])
    if last == len(omegas) - 1 or gains[last + 1] == 0.0:
        return float(omegas[last])
    share = math.log(gains[last]) / math.log(gains[last] / gains[last + 1])
    return float(omegas[last] * (omegas[last + 1] / omegas[last]) ** share)
