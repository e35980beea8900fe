"""ARX models whose rest is not known: order, delay and constant by least squares."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.identification.arx import regressors

_ORDERS = (1, 2, 3)
#: Delays are tried up to this share of the record, and never more than so many.
_LATEST, _MOST = 0.2, 60
#: A triangle whose diagonal shrinks by more is that of dependent columns.
_RANK = 1e-10


@dataclass(frozen=True, eq=False)
class ArxWithRest:
    """y(k) = −Σ a_i y(k−i) + Σ b_j u(k−j−d) + c + e(k).

    Parameters
    ----------
    model : SampledModel
    constant : float
        c, which holds the rest of input and output.
    residuals : ndarray [rows]
        e(k), of the last rows of the record.
    jacobian : ndarray [rows, 2n + 1]
        Of the prediction by a1 … an, b1 … bn, c.

    Examples
    --------
    See `fit_arx_with_rest`.
    """

    model: SampledModel
    constant: float
    residuals: np.ndarray
    jacobian: np.ndarray

    @property
    def rounding(self) -> float:
        """How far the arithmetic may be off in a predicted sample."""
        terms = np.array([*self.model.denominator, *self.model.numerator, self.constant])
        size = float(np.max(np.abs(self.jacobian) @ np.abs(terms)))
        return len(self.residuals) * float(np.finfo(float).eps) * size

    def simulated(self, signal: np.ndarray, output: np.ndarray) -> np.ndarray:
        """Return the output [N] that follows from the input and from the first n outputs."""
        from scipy.signal import lfilter, lfiltic

        order, delay = self.model.order, self.model.delay
        late = np.concatenate([np.full(delay, signal[0]), signal])[: len(signal)]
        driven = lfilter(self.model.B, [1.0], late - signal[0]) + math.fsum(self.model.B) * late[0]
        start = lfiltic([1.0], self.model.A, output[order - 1 :: -1][:order])
        after, _ = lfilter([1.0], self.model.A, driven[order:] + self.constant, zi=start)
        return np.concatenate([output[:order], after])


def fit_arx_with_rest(signal: np.ndarray, output: np.ndarray, period: float) -> ArxWithRest:
    """Fit ARX models of order 1 to 3 with every delay, and keep the best by Schwarz's criterion.

    All are compared on the same samples, those that the longest delay leaves; the one that is
    kept is fitted again on all that its own delay leaves. By QR of the regressors, as the
    normal equations would square their condition.

    Parameters
    ----------
    signal, output : ndarray [N]
        u, held between the samples, and y, as they were measured.
    period : float
        [s]

    Raises
    ------
    InputError
        No order has regressors that the record tells apart.

    References
    ----------
    L. Ljung, System Identification, 2nd ed., 1999, sections 4.2, 10.1 and 16.4.

    Examples
    --------
    >>> u = 3.0 + np.sign(np.sin(1.7 * np.arange(90) ** 1.3))
    >>> y = 12.0 + SampledModel((0.2,), (-0.9,), 4, 1.0).output(u - 3.0)
    >>> fit = fit_arx_with_rest(u, y, 1.0)
    >>> fit.model.in_words(), round(fit.constant, 6)
    ('(0.2 z^-1) / (1 − 0.9 z^-1) z^-4', 0.6)
    """
    longest = longest_delay(len(signal))
    first = max(_ORDERS) + longest
    best, lowest = None, math.inf
    spread = float(np.var(output)) * (len(signal) - first)
    for order in _ORDERS:
        for delay in range(longest + 1):
            skipped = first - order - delay
            solved = _solved(signal[skipped:], output[skipped:], order, delay)
            if solved is None:
                continue
            # An exact fit leaves rounding, which does not choose between models.
            cost = max(float(solved[1] @ solved[1]), 1e-24 * spread)
            rows = len(solved[1])
            criterion = rows * math.log(cost / rows) + 2 * order * math.log(rows)
            if criterion < lowest - 1e-9 * rows:
                best, lowest = (order, delay), criterion
    if best is None:
        raise InputError(
            "ARX", f"{len(signal)} samples", "an input that tells its parameters apart",
            "excite the process by more than one step",
        )  # fmt: skip
    order, delay = best
    return arx_with_rest(signal, output, order=order, delay=delay, period=period)


def longest_delay(samples: int) -> int:
    """Return the longest delay that is tried on a record of so many samples [samples].

    Examples
    --------
    >>> longest_delay(120), longest_delay(5000)
    (24, 60)
    """
    return min(_MOST, int(_LATEST * samples))


def arx_with_rest(
    signal: np.ndarray, output: np.ndarray, *, order: int, delay: int, period: float
) -> ArxWithRest:
    """Fit an ARX model of given order and delay, with a constant.

    Parameters
    ----------
    signal, output : ndarray [N]
    order, delay : int
        n, and d [samples].
    period : float
        [s]

    Raises
    ------
    InputError
        The record does not tell the parameters apart.

    Examples
    --------
    >>> u = 3.0 + np.sign(np.sin(1.7 * np.arange(90) ** 1.3))
    >>> y = 12.0 + SampledModel((0.2,), (-0.9,), 4, 1.0).output(u - 3.0)
    >>> round(arx_with_rest(u, y, order=1, delay=4, period=1.0).constant, 6)
    0.6
    """
    solved = _solved(signal, output, order, delay)
    if solved is None:
        raise InputError(
            "ARX", f"{len(signal)} samples", "an input that tells its parameters apart",
            "excite the process by more than one step, or take a lower order",
        )  # fmt: skip
    theta, residuals, jacobian = solved
    model = SampledModel(tuple(theta[order:-1]), tuple(theta[:order]), delay, period)
    return ArxWithRest(model, float(theta[-1]), residuals, jacobian)


def _solved(
    signal: np.ndarray, output: np.ndarray, order: int, delay: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return parameters, residuals and regressors; None where these depend on each other."""
    F, y = regressors(signal, output, order, delay)
    F = np.concatenate([F, np.ones((len(F), 1))], axis=1)
    sizes = np.linalg.norm(F, axis=0)
    if len(F) <= F.shape[1] or not np.all(sizes):
        return None
    basis, triangle = np.linalg.qr(F / sizes)
    diagonal = np.abs(np.diag(triangle))
    if diagonal.min() <= _RANK * diagonal.max():
        return None
    theta = np.linalg.solve(triangle, basis.T @ y) / sizes
    return theta, y - F @ theta, F
