"""The colour of residuals: an autoregressive model of what a fit leaves over."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: Largest order that is tried, and the share of the samples that it may be of.
_LARGEST, _SHARE = 12, 0.1


@dataclass(frozen=True, eq=False)
class NoiseModel:
    """e(k) + c1 e(k−1) + … + cp e(k−p) = w(k), w white: the coefficients are 1, c1 … cp."""

    coefficients: np.ndarray
    variance: float

    def whitened(self, signals: np.ndarray) -> np.ndarray:
        """Return w of signals [N, …] that have this colour."""
        from scipy.signal import lfilter

        return np.asarray(lfilter(self.coefficients, [1.0], signals, axis=0))

    def coloured(self, signals: np.ndarray) -> np.ndarray:
        """Return signals [N, …] whose w is given."""
        from scipy.signal import lfilter

        return np.asarray(lfilter([1.0], self.coefficients, signals, axis=0))


def noise_model(residuals: np.ndarray) -> NoiseModel:
    """Fit an autoregressive model to residuals [N], of the order that Schwarz's criterion chooses.

    By the Yule-Walker equations, solved by the recursion of Levinson and Durbin, whose models
    are stable.

    References
    ----------
    P. Stoica and R. Moses, Spectral Analysis of Signals, 2005, sections 3.4 and 3.5.
    G. Schwarz, Annals of Statistics 6(2), 1978, 461-464, doi 10.1214/aos/1176344136.

    Examples
    --------
    >>> white = np.random.default_rng(1).standard_normal(4000)
    >>> model = noise_model(NoiseModel(np.array([1.0, -0.8]), 1.0).coloured(white))
    >>> model.coefficients.round(1)
    array([ 1. , -0.8])
    """
    count = len(residuals)
    most = max(1, min(_LARGEST, int(_SHARE * count)))
    lagged = np.array([residuals[k:] @ residuals[: count - k] for k in range(most + 1)]) / count
    coefficients, variance = np.array([1.0]), float(lagged[0])
    best = NoiseModel(coefficients, variance)
    if variance <= 0.0:
        return best
    lowest = count * math.log(variance)
    for order in range(1, most + 1):
        reflection = -float(coefficients @ lagged[order:0:-1]) / variance
        padded = np.append(coefficients, 0.0)
        coefficients = padded + reflection * padded[::-1]
        variance *= 1.0 - reflection**2
        if variance <= 0.0:
            break
        criterion = count * math.log(variance) + order * math.log(count)
        if criterion < lowest:
            lowest, best = criterion, NoiseModel(coefficients, variance)
    return best
