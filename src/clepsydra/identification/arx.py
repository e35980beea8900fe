"""ARX models by least squares, with an offset where no rest is known; which order and delay."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.polynomial.sampled_model import SampledModel

#: A triangle whose diagonal shrinks by more is that of dependent columns.
_RANK = 1e-10
_ORDERS = (1, 2, 3)
#: Delays are tried up to this share of the record, and never more than so many.
_LATEST, _MOST = 0.2, 60


@dataclass(frozen=True, eq=False)
class ArxFit:
    """A model y(k) = −Σ a_i y(k−i) + Σ b_j u(k−j−d) + c + e(k), fitted by least squares.

    The coefficients are a1 … an, b1 … bn and, if there is one, c; the residuals [rows] are e(k) of
    the last samples of the record, and the Jacobian [rows, p] is that of the prediction.
    """

    coefficients: np.ndarray
    residuals: np.ndarray
    jacobian: np.ndarray
    delay: int
    period: float

    @cached_property
    def model(self) -> SampledModel:
        """The model without the offset."""
        order = len(self.coefficients) // 2
        a, b = self.coefficients[:order], self.coefficients[order : 2 * order]
        return SampledModel(tuple(b), tuple(a), self.delay, self.period)

    @property
    def offset(self) -> float:
        """c; zero where there is none."""
        return float(self.coefficients[-1]) if len(self.coefficients) % 2 else 0.0

    @property
    def cost(self) -> float:
        """J, the sum of the squared residuals."""
        return float(self.residuals @ self.residuals)

    @property
    def rounding(self) -> float:
        """How far the arithmetic may be off in a predicted sample."""
        size = float(np.max(np.abs(self.jacobian) @ np.abs(self.coefficients)))
        return len(self.residuals) * float(np.finfo(float).eps) * size

    def simulated(self, signal: np.ndarray, output: np.ndarray) -> np.ndarray:
        """Return the output [N] that follows from the input and from the first n outputs."""
        from scipy.signal import lfilter, lfiltic

        order, delay = self.model.order, self.model.delay
        late = np.concatenate([np.full(delay, signal[0]), signal])[: len(signal)]
        driven = lfilter(self.model.B, [1.0], late - signal[0]) + math.fsum(self.model.B) * late[0]
        start = lfiltic([1.0], self.model.A, output[order - 1 :: -1][:order])
        after, _ = lfilter([1.0], self.model.A, driven[order:] + self.offset, zi=start)
        return np.concatenate([output[:order], after])


def fit_arx(
    signal: np.ndarray,
    output: np.ndarray,
    *,
    order: int,
    delay: int,
    period: float,
    offset: bool = False,
) -> ArxFit:
    """Fit an ARX model of order n and delay d [samples] by least squares.

    Input and output [N] are deviations from rest, or with an offset as they were measured; the
    period is in s. By QR of the regressors, as the normal equations would square their condition.
    Parameters that the record does not tell apart are an InputError.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, eq. (12) to (17): F has N − n − d rows and 2n columns.

    Examples
    --------
    >>> u = np.sign(np.sin(1.7 * np.arange(60) ** 1.3))
    >>> tank = SampledModel((0.2,), (-0.9,), 3, 1.0)
    >>> raised = fit_arx(u + 3, tank.output(u) + 12, order=1, delay=3, period=1.0, offset=True)
    >>> raised.coefficients.round(6)
    array([-0.9,  0.2,  0.6])
    """
    F, y = regressors(signal, output, order, delay)
    if offset:
        F = np.concatenate([F, np.ones((len(F), 1))], axis=1)
    sizes = np.linalg.norm(F, axis=0)
    if len(F) > len(sizes) and np.all(sizes):
        basis, triangle = np.linalg.qr(F / sizes)
        diagonal = np.abs(np.diag(triangle))
        if diagonal.min() > _RANK * diagonal.max():
            theta = np.linalg.solve(triangle, basis.T @ y) / sizes
            return ArxFit(theta, y - F @ theta, F, delay, period)
    raise InputError(
        "ARX, signal", f"{len(signal)} samples",
        f"an input that tells {len(sizes)} parameters apart",
        "excite the process by more than a step or a single sine, or take a lower order",
    )  # fmt: skip


def regressors(
    signal: np.ndarray, output: np.ndarray, order: int, delay: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return F [N − n − d, 2n] and y [N − n − d] of equation (11).

    Examples
    --------
    >>> F, y = regressors(np.arange(6.0), 10 * np.arange(6.0), order=1, delay=2)
    >>> F.tolist(), y.tolist()
    ([[-20.0, 0.0], [-30.0, 1.0], [-40.0, 2.0]], [30.0, 40.0, 50.0])
    """
    first = order + delay
    count = len(output)
    columns = [-output[first - i : count - i] for i in range(1, order + 1)]
    columns += [signal[first - i - delay : count - i - delay] for i in range(1, order + 1)]
    return np.stack(columns, axis=1), output[first:]


def choose_arx(signal: np.ndarray, output: np.ndarray, period: float) -> ArxFit:
    """Fit ARX models with an offset, and keep the best by Schwarz's criterion.

    They are of order 1 to 3 with every delay. All are compared on the same samples, those that
    the longest delay leaves; the one that is kept is fitted again on all that its own leaves. A
    record that tells the parameters of none apart is an InputError.

    References
    ----------
    L. Ljung, System Identification, 2nd ed., 1999, sections 4.2, 10.1 and 16.4.
    """
    longest, most = longest_delay(len(signal)), max(_ORDERS)
    best, lowest = None, math.inf
    spread = float(np.var(output)) * (len(signal) - most - longest)
    for order in _ORDERS:
        u, y = signal[most - order :], output[most - order :]
        fits = fits_by_delay(u, y, order=order, delays=range(longest + 1), offset=True)
        for delay, fit in fits.items():
            rows = len(fit.residuals)
            # An exact fit leaves rounding, which does not choose between models.
            cost = max(fit.cost, 1e-24 * spread)
            criterion = rows * math.log(cost / rows) + 2 * order * math.log(rows)
            if criterion < lowest - 1e-9 * rows:
                best, lowest = (order, delay), criterion
    if best is None:
        raise InputError(
            "ARX", f"{len(signal)} samples", "an input that tells its parameters apart",
            "excite the process by more than one step",
        )  # fmt: skip
    order, delay = best
    return fit_arx(signal, output, order=order, delay=delay, period=period, offset=True)


def longest_delay(samples: int) -> int:
    """Return the longest delay that is tried on a record of so many samples [samples]."""
    return min(_MOST, int(_LATEST * samples))


def fits_by_delay(
    signal: np.ndarray,
    output: np.ndarray,
    *,
    order: int,
    delays: Sequence[int],
    period: float = 1.0,
    offset: bool = False,
) -> dict[int, ArxFit]:
    """Fit an ARX model with each delay [samples]; those that the record does not tell are left out.

    The longer the delay the fewer samples can be fitted; so that every cost J(d) is a sum over the
    same samples, those that the longest delay leaves, the others leave out as many.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, eq. (17) and Fig. 3.

    Examples
    --------
    >>> u = np.sign(np.sin(1.7 * np.arange(90) ** 1.3))
    >>> y = SampledModel((0.2,), (-0.9,), 4, 1.0).output(u)
    >>> fits = fits_by_delay(u, y, order=1, delays=range(9))
    >>> min(fits, key=lambda delay: fits[delay].cost)
    4
    """
    fits = {}
    for delay in delays:
        u, y = (each[max(delays) - delay :] for each in (signal, output))
        with suppress(InputError):
            fits[delay] = fit_arx(u, y, order=order, delay=delay, period=period, offset=offset)
    return fits
