"""The sensitivity peaks of many sampled loops at once."""

from __future__ import annotations

import numpy as np

from clepsydra.designs.sampled.sampled_loop import SampledLoop
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.linear.frequency_peak import largest_gains


def sensitivity_peaks(loops: SampledLoop) -> np.ndarray:
    """Return max|S| of each of a stack of loops [k], `SampledLoop.maximum_sensitivity`.

    Examples
    --------
    An integrator under proportional control that takes a half, a quarter and 2.5 times its error:

    >>> gains, one = np.array([0.5, 0.25, 2.5])[:, None, None], np.ones((3, 1, 1))
    >>> sensitivity_peaks(SampledLoop(1.0 - gains, -gains, one, one)).round(6)
    array([1.333333, 1.142857,      inf])
    """
    found, stable = np.full(len(loops.A), np.inf), loops.are_stable
    images = SampledSystem(*(matrix[stable] for matrix in loops)).continuous_image()
    found[stable] = [each.peak for each in largest_gains(*images)]
    return found
