"""Which order and delay of an ARX model explains a record best."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.identification.arx import (
    ArxFit,
    checked_records,
    fit_arx,
    least_squares,
    whole_number,
)

_ORDERS = (1, 2, 3)
#: Delays are tried up to this share of the record, and never more than so many.
_LATEST, _MOST = 0.2, 60


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
