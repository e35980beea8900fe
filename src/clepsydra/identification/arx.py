"""ARX models by least squares, with an offset where no rest is known; which order and delay."""

from __future__ import annotations

import math
from collections.abc import Iterable
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

    The residuals [rows] are e(k) of the last samples of the record; the Jacobian [rows, p] is that
    of the prediction by a1 … an, b1 … bn and, if there is one, c.
    """

    model: SampledModel
    residuals: np.ndarray
    jacobian: np.ndarray
    offset: float | None = None

    @property
    def cost(self) -> float:
        """J, the sum of the squared residuals."""
        return float(self.residuals @ self.residuals)

    @cached_property
    def coefficients(self) -> np.ndarray:
        """a1 … an, b1 … bn and, if there is one, c."""
        constant = () if self.offset is None else (self.offset,)
        return np.array([*self.model.denominator, *self.model.numerator, *constant])

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
        after, _ = lfilter([1.0], self.model.A, driven[order:] + (self.offset or 0.0), zi=start)
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
    period is in s. A number out of its range, records that differ in length, have a gap, do not
    move or are too short, and parameters that they do not tell apart are an InputError.

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
    signal, output = checked_records(signal, output)
    order = whole_number("ARX, order", order, 1)
    delay = whole_number("ARX, delay", delay, 0)
    parameters = 2 * order + offset
    needed = parameters + 1
    if len(output) - order - delay < needed:
        raise InputError(
            "ARX, records", f"{len(signal)} samples",
            f"at least {needed + order + delay}, so that there are more equations than the "
            f"{parameters} parameters",
            "record for longer, or take a lower order or a shorter delay",
        )  # fmt: skip
    solved = least_squares(signal, output, order, delay, offset=offset)
    if solved is None:
        raise InputError(
            "ARX, signal", f"{len(signal)} samples",
            f"an input that tells {parameters} parameters apart",
            "excite the process by more than a step or a single sine, or take a lower order",
        )  # fmt: skip
    theta, residuals, jacobian = solved
    model = SampledModel(tuple(theta[order : 2 * order]), tuple(theta[:order]), delay, period)
    return ArxFit(model, residuals, jacobian, float(theta[-1]) if offset else None)


def least_squares(
    signal: np.ndarray, output: np.ndarray, order: int, delay: int, *, offset: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return parameters, residuals and regressors; None where these depend on each other.

    By QR of the regressors, as the normal equations would square their condition.
    """
    F, y = regressors(signal, output, order, delay)
    if offset:
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


def whole_number(place: str, value: object, least: int) -> int:
    """Return a whole number from `least` on; any other value is an InputError."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool) and value >= least:
        return int(value)
    raise InputError(
        place, value, f"a whole number of at least {least}",
        "give a delay in sampling periods, rounded to whole ones"
        if "delay" in place
        else "correct it",
    )  # fmt: skip


def checked_records(signal: np.ndarray, output: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return input and output as arrays of numbers that move.

    Records that differ in length, have a gap or do not move are an InputError.
    """
    found = []
    for name, values in (("input", signal), ("output", output)):
        record = np.asarray(values, dtype=float)
        if record.ndim != 1 or not record.size:
            raise InputError(
                f"record of the {name}", list(record.shape), "one value for each sample",
                "give one column of numbers",
            )  # fmt: skip
        gaps = np.flatnonzero(~np.isfinite(record))
        if gaps.size:
            raise InputError(
                f"record of the {name}, sample {gaps[0]}", record[gaps[0]], "a number",
                "fill the gap, or identify from the longest stretch without one",
            )  # fmt: skip
        if np.ptp(record) == 0.0:
            raise InputError(
                f"record of the {name}", f"{record[0]:g} in all {record.size} samples",
                "a signal that moves",
                "record while the input moves the process",
            )  # fmt: skip
        found.append(record)
    if found[0].size != found[1].size:
        raise InputError(
            "records", f"{found[0].size} samples of the input and {found[1].size} of the output",
            "as many of both", "cut them to the same samples",
        )  # fmt: skip
    return found[0], found[1]


def choose_arx(signal: np.ndarray, output: np.ndarray, period: float) -> ArxFit:
    """Fit ARX models with an offset, and keep the best by Schwarz's criterion.

    They are of order 1 to 3 with every delay. All are compared on the same samples, those that
    the longest delay leaves; the one that is kept is fitted again on all that its own leaves. A
    record that tells the parameters of none apart is an InputError.

    References
    ----------
    L. Ljung, System Identification, 2nd ed., 1999, sections 4.2, 10.1 and 16.4.
    """
    longest = longest_delay(len(signal))
    first = max(_ORDERS) + longest
    best, lowest = None, math.inf
    spread = float(np.var(output)) * (len(signal) - first)
    for order in _ORDERS:
        for delay in range(longest + 1):
            skipped = first - order - delay
            solved = least_squares(signal[skipped:], output[skipped:], order, delay, offset=True)
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
    return fit_arx(signal, output, order=order, delay=delay, period=period, offset=True)


def longest_delay(samples: int) -> int:
    """Return the longest delay that is tried on a record of so many samples [samples]."""
    return min(_MOST, int(_LATEST * samples))


@dataclass(frozen=True, eq=False)
class DelayChoice:
    """Fits with several delays [samples], and the one that explains the record best."""

    delays: tuple[int, ...]
    fits: tuple[ArxFit, ...]

    @cached_property
    def costs(self) -> np.ndarray:
        """J(d): the sum of squared residuals of the same samples for each delay."""
        return np.array([fit.cost for fit in self.fits])

    @property
    def delay(self) -> int:
        """d of the smallest J."""
        return self.delays[int(np.argmin(self.costs))]

    @property
    def fit(self) -> ArxFit:
        """The fit with that delay."""
        return self.fits[int(np.argmin(self.costs))]


def choose_delay(
    signal: np.ndarray, output: np.ndarray, *, order: int, delays: Iterable[int], period: float
) -> DelayChoice:
    """Fit an ARX model with each delay and choose the one of the smallest J(d).

    The longer the delay the fewer samples can be fitted; so that every J is a sum over the same
    samples, those that the longest delay leaves. Refused as by `fit_arx`, and without a delay.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, eq. (17) and Fig. 3.

    Examples
    --------
    >>> from clepsydra.designs.polynomial.sampled_model import SampledModel
    >>> u = np.sign(np.sin(1.7 * np.arange(90) ** 1.3))
    >>> y = SampledModel((0.2,), (-0.9,), 4, 1.0).output(u)
    >>> choose_delay(u, y, order=1, delays=range(9), period=1.0).delay
    4
    """
    signal, output = checked_records(signal, output)
    candidates = tuple(whole_number("choice of the delay, delays", each, 0) for each in delays)
    if not candidates:
        raise InputError(
            "choice of the delay, delays", [], "delays to try", "give some, as range(9)"
        )
    longest = max(candidates)
    fits = tuple(
        fit_arx(
            signal[longest - delay :], output[longest - delay :],
            order=order, delay=delay, period=period,
        )
        for delay in candidates
    )  # fmt: skip
    return DelayChoice(candidates, fits)
