"""Confidence intervals of a least-squares fit, from its Jacobian."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.identification.residual_tests import NoiseModel

#: Of every interval.
LEVEL = 0.95
#: Weaker directions of the Jacobian, its columns brought to one size, carry no information.
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """How far estimates may be from the truth."""

    covariance: np.ndarray  # [p, p], that of coloured residuals where they are and it is larger
    freedom: int  # residuals less parameters
    widening: float  # largest factor by which the colour widens an interval

    @property
    def deviations(self) -> np.ndarray:
        """Standard deviations of the estimates [p]."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def reach(self) -> np.ndarray:
        """Half the width of each 95 % interval [p], by Student's t."""
        from scipy.stats import t

        return np.asarray(t.ppf(0.5 + 0.5 * LEVEL, self.freedom) * self.deviations)

    def reach_of(self, gradient: np.ndarray) -> float:
        """Return half the width of the interval of a function with a gradient [p]."""
        from scipy.stats import t

        deviation = np.sqrt(max(float(gradient @ self.covariance @ gradient), 0.0))
        return float(t.ppf(0.5 + 0.5 * LEVEL, self.freedom) * deviation)

    @property
    def correlations(self) -> np.ndarray:
        """How far estimates err together [p, p]; those without any error do not."""
        sizes = np.outer(self.deviations, self.deviations)
        return np.divide(self.covariance, sizes, out=np.zeros_like(sizes), where=sizes > 0.0)


def uncertainty(
    jacobian: np.ndarray, residuals: np.ndarray, noises: Sequence[NoiseModel | None] = (None,)
) -> Uncertainty:
    """Return how sure the estimates of a least-squares fit are.

    White residuals: s² (J'J)⁻¹, the inverse of Fisher's information with the residuals' own
    variance. Coloured ones: (J'J)⁻¹ J' Ω J (J'J)⁻¹, with Ω of their noise model.

    Parameters
    ----------
    jacobian : ndarray [N, p] or [outputs, N, p]
    residuals : ndarray [N] or [outputs, N]
        Of several outputs brought to one size, and independent of each other.
    noises : sequence of NoiseModel or None
        The colour of each output's residuals; None for white ones.

    Raises
    ------
    InputError
        The record does not tell the parameters apart.

    References
    ----------
    G. A. F. Seber and C. J. Wild, Nonlinear Regression, 1989, sections 5.1 and 6.2.

    Examples
    --------
    The mean of n numbers:

    >>> numbers = np.array([1.0, 2.0, 4.0, 5.0])
    >>> found = uncertainty(np.ones((4, 1)), numbers - 3.0)
    >>> found.deviations.round(6), round(float(np.std(numbers, ddof=1)) / 2.0, 6)
    (array([0.912871]), 0.912871)
    """
    left = np.atleast_2d(residuals)
    slopes = jacobian.reshape(*left.shape, -1)
    parameters = slopes.shape[-1]
    inverse = inverse_information(slopes.reshape(-1, parameters))
    freedom = left.size - parameters
    variance = float(np.sum(left**2)) / freedom
    white = variance * inverse
    if all(noise is None for noise in noises):
        return Uncertainty(white, freedom, 1.0)
    # J'ΩJ = s² (H'J)'(H'J), H the filter that colours: H' runs it backwards in time.
    halves = [
        np.sqrt(variance) * slope
        if noise is None
        else np.sqrt(noise.variance * left.size / freedom) * noise.coloured(slope[::-1])
        for slope, noise in zip(slopes, noises, strict=True)
    ]
    half = np.concatenate(halves) @ inverse
    coloured = half.T @ half
    ratios = np.sqrt(np.diag(coloured) / np.diag(white))
    grown = np.maximum(1.0, 1.0 / ratios)  # no interval gets narrower by its colour
    return Uncertainty(coloured * np.outer(grown, grown), freedom, max(1.0, float(ratios.max())))


def inverse_information(jacobian: np.ndarray) -> np.ndarray:
    """Return (J'J)⁻¹ by the singular values of J, or refuse columns that depend on each other."""
    sizes = np.linalg.norm(jacobian, axis=0)
    sizes[sizes == 0.0] = 1.0
    _, strengths, directions = np.linalg.svd(jacobian / sizes, full_matrices=False)
    if len(strengths) < jacobian.shape[1] or strengths[-1] <= _RANK * strengths[0]:
        raise InputError(
            "record", f"{len(jacobian)} samples",
            f"an input that tells {jacobian.shape[1]} parameters apart",
            "excite the process by more than one step, or fit fewer parameters",
        )  # fmt: skip
    return np.asarray((directions.T / strengths**2) @ directions / np.outer(sizes, sizes))
