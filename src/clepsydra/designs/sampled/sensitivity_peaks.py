"""The sensitivity peaks of many sampled loops at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.designs.sampled.sampled_loop import SampledLoop
from clepsydra.linear.frequency_peak import largest_gains


class SensitivityPeaks(NamedTuple):
    """max|S| of each of some loops [k, 1], infinite if unstable, and at which angles ωT [k, rad].

    An angle of a loop that is unstable is not a number.
    """

    values: np.ndarray
    angles: np.ndarray


def sensitivity_peaks(loops: SampledLoop) -> SensitivityPeaks:
    """Return max|S| of each of a stack of loops, `SampledLoop.maximum_sensitivity`.

    Examples
    --------
    An integrator under proportional control that takes a half, a quarter and 2.5 times its error:

    >>> gains, one = np.array([0.5, 0.25, 2.5])[:, None, None], np.ones((3, 1, 1))
    >>> sensitivity_peaks(SampledLoop(1.0 - gains, -gains, one, one)).values.round(6)
    array([1.333333, 1.142857,      inf])
    """
    stable, count = loops.are_stable, len(loops.A)
    values, angles = np.full(count, np.inf), np.full(count, np.nan)
    found = largest_gains(*loops.among(stable).continuous_image())
    values[stable] = [each.peak for each in found]
    angles[stable] = [2.0 * np.arctan(each.frequency) for each in found]
    return SensitivityPeaks(values, angles)
