"""The sensitivity peaks of many sampled loops at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.designs.sampled.sampled_loop import SampledLoop
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.linear.frequency_peak import largest_gains


def sensitivity_peaks(loops: Sequence[SampledLoop]) -> list[float]:
    """Return max|S| of each loop [1], `SampledLoop.maximum_sensitivity`; infinite if unstable.

    Examples
    --------
    An integrator under proportional control that takes a half, a quarter and 2.5 times its error:

    >>> one = np.eye(1)
    >>> loops = [SampledLoop((1.0 - K) * one, -K * one, one, one) for K in (0.5, 0.25, 2.5)]
    >>> [round(peak, 6) for peak in sensitivity_peaks(loops)]
    [1.333333, 1.142857, inf]
    """
    found = [math.inf] * len(loops)
    alike: dict[tuple[int, ...], list[int]] = {}
    for place, loop in enumerate(loops):
        alike.setdefault((*loop.B.shape, len(loop.C)), []).append(place)
    for places in alike.values():
        stack = SampledSystem(*map(np.array, zip(*(loops[each] for each in places), strict=True)))
        stable = np.flatnonzero(stack.are_stable)
        images = SampledSystem(*(matrix[stable] for matrix in stack)).continuous_image()
        for place, peak in zip(stable.tolist(), largest_gains(*images), strict=True):
            found[places[place]] = peak.peak
    return found
