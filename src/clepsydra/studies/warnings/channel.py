"""The margins of one channel of a sampled loop, read off its frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

#: An imaginary part below this share is rounding: half way round the circle L is real.
_ROUNDING = 1e-9


class Margin(NamedTuple):
    """A margin, and the frequency at which the loop would then oscillate.

    Parameters
    ----------
    value : float
        A factor on the gain [1] or a phase [rad]; infinite where no change is too much.
    frequency : float
        [rad/s]; not a number for none.
    """

    value: float
    frequency: float


@dataclass(frozen=True, eq=False)
class Channel:
    """L(e^jωT) of one channel while the others stay closed.

    Crossings are interpolated between the frequencies, which is exact to about 1e-4 with sixty
    of them a decade.

    Parameters
    ----------
    frequencies : ndarray [l]
        Rising; the last is half the sampling frequency [rad/s].
    loop : ndarray [l], complex

    Examples
    --------
    L = 0.5/(z - 1) with T = 1 s withstands four times the gain:

    >>> frequencies = np.linspace(0.01, np.pi, 400)
    >>> channel = Channel(frequencies, 0.5 / (np.exp(1j * frequencies) - 1.0))
    >>> [round(number, 3) for number in channel.gain_margin]
    [4.0, 3.142]
    """

    frequencies: np.ndarray
    loop: np.ndarray

    @cached_property
    def crossovers(self) -> np.ndarray:
        """Frequencies at which |L| = 1 [rad/s]; the last frequency where |L| stays above."""
        found = np.exp(_at_zeros(self._size, np.log(self.frequencies)))
        return np.append(found, self.frequencies[-1:] if self._size[-1] >= 0.0 else [])

    @property
    def bandwidth(self) -> float:
        """The fastest frequency at which |L| = 1 [rad/s]; 0 where there is none."""
        return float(self.crossovers.max(initial=0.0))

    @cached_property
    def gain_margin(self) -> Margin:
        """The factor nearest to one that puts L through -1."""
        across = np.where(
            np.abs(self.loop.imag) <= _ROUNDING * np.abs(self.loop), 0.0, self.loop.imag
        )
        real = _at_zeros(across, self.loop.real)
        frequencies = _at_zeros(across, self.frequencies)
        if across[-1] == 0.0:
            real = np.append(real, self.loop[-1].real)
            frequencies = np.append(frequencies, self.frequencies[-1])
        margins = [
            Margin(-1.0 / float(value), float(omega))
            for value, omega in zip(real, frequencies, strict=True)
            if value < 0.0
        ]
        none = Margin(np.inf, np.nan)
        return min(margins, key=lambda margin: abs(np.log(margin.value)), default=none)

    @cached_property
    def phase_margin(self) -> Margin:
        """The least change of phase that puts L through -1."""
        angles = _at_zeros(self._size, np.unwrap(np.angle(-self.loop)))
        turned = np.abs(np.angle(np.exp(1j * angles)))
        margins = [
            Margin(float(a), float(w)) for a, w in zip(turned, self.crossovers, strict=False)
        ]
        return min(margins, default=Margin(np.inf, np.nan))

    @cached_property
    def _size(self) -> np.ndarray:
        """The logarithm of |L|."""
        return np.asarray(np.log(np.maximum(np.abs(self.loop), 1e-300)))


def _at_zeros(function: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values where a function of the same grid changes its sign, linearly between."""
    left = np.flatnonzero(function[:-1] * function[1:] < 0.0)
    share = function[left] / (function[left] - function[left + 1])
    return np.asarray(values[left] + share * (values[left + 1] - values[left]))
