"""The gain of a pump, from the rise of a tank whose outlet is plugged."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.identification.uncertainty import uncertainty


def pump_gain(
    time: ArrayLike, level: ArrayLike, signal: ArrayLike, area: float, *, dead_band: float = 0.0
) -> tuple[float, float]:
    """Return the gain k of a pump whose whole flow q = k max(v − v₀, 0) stays in one tank.

    With it comes half the width of its 95 % interval. The outlet of the tank is plugged and the
    valve sends all of the flow into it, so that A dh/dt = q. The volume gained in each sample is
    regressed on the signal held during it; the interval is Student's, exact where the flow is
    noisy by the same amount in every sample, as at a constant signal. Noise of the level sensor
    widens the interval without biasing the gain.

    Parameters
    ----------
    time, level : array_like [n]
        Start of each sample [s], rising, and the level there [m].
    signal : array_like [n]
        v, held from each time to the next, in its unit; the last one does not count.
    area, dead_band : float
        Cross-section of the tank [m²], and v₀, below which nothing flows.

    Raises
    ------
    InputError
        The pump stands still throughout.

    Examples
    --------
    6 cm³/s from 2 V raise 15 cm² by 0.4 cm each second, as read to a tenth of a millimetre:

    >>> time = np.arange(4.0)
    >>> gain, reach = pump_gain(time, [0.0, 0.0041, 0.0079, 0.0120], np.full(4, 2.0), 15e-4)
    >>> round(1e6 * gain, 6), round(1e6 * reach, 3)
    (3.0, 0.323)
    """
    pumped = np.diff(time) * np.maximum(np.asarray(signal, float)[:-1] - dead_band, 0.0)
    gained = area * np.diff(level)
    gain = float(np.linalg.lstsq(pumped[:, None], gained, rcond=None)[0][0])
    return gain, float(uncertainty(pumped[:, None], gained - gain * pumped).reach[0])
