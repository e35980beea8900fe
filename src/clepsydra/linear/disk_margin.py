"""The disk margin: how much gain and phase may change together, in one loop or in all."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clepsydra.linear.frequency_grid import frequency_grid
from clepsydra.linear.frequency_peak import highest
from clepsydra.linear.interconnection import feedback, require_square
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.stability import asymptotically_stable
from clepsydra.linear.structured_norm import structured_norm


class DiskMargin(NamedTuple):
    """A symmetric disk of complex factors that the loop withstands, in every channel at once.

    A factor in each channel may be any (1 + δ/2)/(1 - δ/2) with |δ| < α.

    Parameters
    ----------
    size : float
        α [1], from 0 (not stable) to 2.
    frequency : float
        Where the smallest destabilising factor oscillates [rad/s]; not a number when the loop
        is unstable.

    Examples
    --------
    >>> margin = DiskMargin(2.0 / 3.0, 1.0)
    >>> round(margin.gain, 6), round(math.degrees(margin.phase), 2)
    (2.0, 36.87)
    """

    size: float
    frequency: float

    @property
    def gain(self) -> float:
        """The gain may be multiplied or divided by this [1]; infinite for α = 2."""
        return (2.0 + self.size) / (2.0 - self.size) if self.size < 2.0 else math.inf

    @property
    def phase(self) -> float:
        """The phase may change by this, up or down [rad]."""
        return 2.0 * math.atan(self.size / 2.0)


def disk_margin(loop: LinearModel) -> DiskMargin:
    """Return the symmetric disk margin α = 1 / max μ(S - I/2) of a loop, over all frequencies.

    For one channel μ is the modulus, so α = 2/max|S - T|. For several, every channel is changed
    independently and at once: the multiloop disk margin. μ is then its bound by diagonal
    scaling, which is exact for up to three channels and for more makes α err to the safe side.

    Parameters
    ----------
    loop : LinearModel
        L, with as many outputs as inputs, closed by negative unity feedback. Broken at the
        plant output it is G K, at the plant input K G.

    Returns
    -------
    DiskMargin

    Raises
    ------
    InputError
        L is not square or not well posed, or its stability cannot be decided.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, An Introduction to Disk Margins, IEEE Control Systems
    Magazine 40(5), 2020, 78-95, doi 10.1109/MCS.2020.3005277, with the skew at zero.

    Examples
    --------
    L = 25/(s³ + 10 s² + 10 s + 10), the example of the reference:

    >>> A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-10.0, -10.0, -10.0]])
    >>> B, C = np.array([[0.0], [0.0], [25.0]]), np.array([[1.0, 0.0, 0.0]])
    >>> loop = LinearModel(A, B, B[:, :0], C, np.zeros((1, 1)), ("a", "b", "c"), ("u",), (),
    ...                    ("y",))
    >>> margin = disk_margin(loop)
    >>> round(margin.size, 2), round(margin.gain, 2), round(margin.frequency, 3)
    (0.46, 1.59, 1.955)
    """
    size = require_square(loop)
    closed = feedback(loop)
    if not asymptotically_stable(closed):
        return DiskMargin(0.0, math.nan)
    identity = np.eye(size)
    peak = highest(
        closed,
        frequency_grid(loop, closed),
        lambda values: structured_norm(identity / 2.0 - values),  # S - I/2 = I/2 - T
    )
    return DiskMargin(min(1.0 / peak.peak, 2.0), peak.frequency)
