"""ARX models with delay by least squares."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.polynomial.sampled_model import SampledModel

#: A direction of the regressors this much weaker than the strongest carries no information.
_RANK = 1e-10


@dataclass(frozen=True, eq=False)
class ArxFit:
    """A model y(k) = −Σ a_i y(k−i) + Σ b_j u(k−j−d) + e(k), fitted by least squares.

    Parameters
    ----------
    model : SampledModel
    covariance : ndarray [2n, 2n]
        Of a1 … an, b1 … bn.
    residuals : ndarray [rows]
        e(k) of the samples that were fitted, the last ones of the record.

    Examples
    --------
    See `fit_arx`.
    """

    model: SampledModel
    covariance: np.ndarray
    residuals: np.ndarray

    @property
    def cost(self) -> float:
        """J, the sum of the squared residuals."""
        return float(self.residuals @ self.residuals)

    @cached_property
    def coefficients(self) -> np.ndarray:
        """a1 … an, b1 … bn."""
        return np.array([*self.model.denominator, *self.model.numerator])

    def intervals(self, level: float = 0.95) -> np.ndarray:
        """Return the confidence intervals of a1 … an, b1 … bn [2n, 2] by Student's t.

        They hold where the noise is white and enters as e(k).

        Parameters
        ----------
        level : float
            Between 0 and 1.

        Raises
        ------
        InputError
            The level is not between 0 and 1.
        """
        from scipy.stats import t

        if not 0.0 < level < 1.0:
            raise InputError("ARX, level", level, "a number between 0 and 1", "say 0.95")
        freedom = len(self.residuals) - len(self.coefficients)
        reach = t.ppf(0.5 + 0.5 * level, freedom) * np.sqrt(np.diag(self.covariance))
        return np.stack([self.coefficients - reach, self.coefficients + reach], axis=1)


def fit_arx(
    signal: np.ndarray, output: np.ndarray, *, order: int, delay: int, period: float
) -> ArxFit:
    """Fit an ARX model of given order and delay by least squares.

    Parameters
    ----------
    signal, output : ndarray [N]
        u and y as deviations from rest, sampled with the input held in between.
    order : int
        n
    delay : int
        d [samples]
    period : float
        T0 [s]

    Raises
    ------
    InputError
        Order or delay is no whole number in its range, the records differ in length, have a gap
        or do not move, there are too few samples, or they do not tell the parameters apart.

    References
    ----------
    V. Bobál, S. Talaš, P. Dostál, M. Kubalčík, Polynomial Digital Control of a Series Equal
    Liquid Tanks, eq. (12) to (17): F has N − n − d rows and 2n columns.

    Examples
    --------
    >>> u = np.sign(np.sin(1.7 * np.arange(60) ** 1.3))
    >>> tank = SampledModel((0.2,), (-0.9,), 3, 1.0)
    >>> fit = fit_arx(u, tank.output(u), order=1, delay=3, period=1.0)
    >>> fit.coefficients.round(9), fit.cost < 1e-20
    (array([-0.9,  0.2]), True)
    """
    signal, output = checked_records(signal, output)
    order = whole_number("ARX, order", order, 1)
    delay = whole_number("ARX, delay", delay, 0)
    needed = 2 * order + 1
    if len(output) - order - delay < needed:
        raise InputError(
            "ARX, records", f"{len(signal)} samples",
            f"at least {needed + order + delay}, so that there are more equations than the "
            f"{2 * order} parameters",
            "record for longer, or take a lower order or a shorter delay",
        )  # fmt: skip
    F, y = regressors(signal, output, order, delay)
    sizes = np.sqrt(np.mean(F**2, axis=0))
    sizes[sizes == 0.0] = 1.0
    _, strengths, directions = np.linalg.svd(F / sizes, full_matrices=False)
    if strengths[-1] <= _RANK * strengths[0]:
        raise InputError(
            "ARX, signal", f"{len(signal)} samples",
            f"an input that tells {2 * order} parameters apart",
            "excite the process by more than a step or a single sine, or take a lower order",
        )  # fmt: skip
    inverse = (directions.T / strengths**2) @ directions / np.outer(sizes, sizes)
    theta = np.linalg.lstsq(F / sizes, y, rcond=None)[0] / sizes
    residuals = y - F @ theta
    variance = float(residuals @ residuals) / (len(y) - 2 * order)
    model = SampledModel(tuple(theta[order:]), tuple(theta[:order]), delay, period)
    return ArxFit(model, variance * inverse, residuals)


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
    """Return a whole number from `least` on.

    Raises
    ------
    InputError

    Examples
    --------
    >>> whole_number("ARX, delay", 5, 0)
    5
    """
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

    Raises
    ------
    InputError
        They differ in length, have a gap, or do not move.

    Examples
    --------
    >>> checked_records([0, 1, 0], [5, 5, 5])
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: record of the output: got '5 in all 3 samples', expected a \
signal that moves; record while the input moves the process.
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
