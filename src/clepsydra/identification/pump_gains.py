"""The gain of a pump, from the rise of a tank whose outlet is plugged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError

#: Of an interval that covers the truth.
CONFIDENCE = 0.95
_FEWEST = 3


@dataclass(frozen=True)
class IntervalEstimate:
    """A number found from data, and the interval that covers the truth 95 times out of 100."""

    value: float
    standard_error: float
    low: float
    high: float


def pump_gain(
    time: ArrayLike, level: ArrayLike, signal: ArrayLike, area: float, *, dead_band: float = 0.0
) -> IntervalEstimate:
    """Return the gain k of a pump whose whole flow q = k max(v − v₀, 0) stays in one tank.

    The outlet of the tank is plugged and the valve sends all of the flow into it, so that
    A dh/dt = q. The volume gained in each sample is regressed on the signal held during it; the
    interval is Student's, exact where the flow is noisy by the same amount in every sample, as
    at a constant signal. Noise of the level sensor widens the interval without biasing the
    gain.

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
        There are fewer than three samples, a value is no number, time does not rise, the pump
        stands still throughout, or the area is not above zero.

    Examples
    --------
    6 cm³/s from 2 V raise 15 cm² by 0.4 cm each second, as read to a tenth of a millimetre:

    >>> time = np.arange(4.0)
    >>> found = pump_gain(time, [0.0, 0.0041, 0.0079, 0.0120], np.full(4, 2.0), 15e-4)
    >>> round(1e6 * found.value, 6), round(1e6 * found.low, 3), round(1e6 * found.high, 3)
    (3.0, 2.677, 3.323)
    """
    clock, heights, moved = _read(time, level, signal)
    if not (np.isfinite(area) and area > 0.0):
        raise InputError("pump gain, area", area, "a cross-section above 0 m²", "give it in m²")
    pumped = np.diff(clock) * np.maximum(moved[:-1] - dead_band, 0.0)
    if not np.any(pumped > 0.0):
        raise InputError(
            "pump gain, signal",
            f"at most {float(moved.max()):g}",
            f"a signal above the dead band of {dead_band:g}",
            "record while the pump runs",
        )
    gained = area * np.diff(heights)
    value = float(pumped @ gained / (pumped @ pumped))
    left = gained - value * pumped
    freedom = len(pumped) - 1
    error = float(np.sqrt(left @ left / freedom / (pumped @ pumped)))
    return interval(value, error, freedom)


def interval(value: float, error: float, freedom: int) -> IntervalEstimate:
    """Return the interval of a value with a standard error, by Student's distribution."""
    from scipy.stats import t

    reach = float(t.ppf(0.5 + 0.5 * CONFIDENCE, freedom)) * error
    return IntervalEstimate(value, error, value - reach, value + reach)


def _read(
    time: ArrayLike, level: ArrayLike, signal: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    given = {"time": time, "level": level, "signal": signal}
    arrays = {name: np.asarray(values, float).ravel() for name, values in given.items()}
    length = len(arrays["time"])
    for name, values in arrays.items():
        if len(values) != length or length < _FEWEST:
            raise InputError(
                f"pump gain, {name}",
                f"{len(values)} values",
                f"as many as times, {length}, and at least {_FEWEST}",
                "give one value for each time",
            )
        if not np.all(np.isfinite(values)):
            raise InputError(
                f"pump gain, {name}", "a gap", "numbers throughout", "leave out the rows with gaps"
            )
    if not np.all(np.diff(arrays["time"]) > 0.0):
        raise InputError(
            "pump gain, time", "times that do not rise", "rising times", "sort the rows by time"
        )
    return arrays["time"], arrays["level"], arrays["signal"]
