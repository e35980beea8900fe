"""The number of delay steps by the criterion J(d) of least squares."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.identification.arx import ArxFit, checked_records, fit_arx, whole_number


@dataclass(frozen=True, eq=False)
class DelayChoice:
    """Fits with several delays, and the one that explains the record best.

    Parameters
    ----------
    delays : tuple of int
        [samples]
    costs : ndarray
        J(d): the sum of squared residuals of the same samples for each delay.
    fits : tuple of ArxFit

    Examples
    --------
    See `choose_delay`.
    """

    delays: tuple[int, ...]
    costs: np.ndarray
    fits: tuple[ArxFit, ...]

    @property
    def delay(self) -> int:
        """d of the smallest J."""
        return self.delays[int(np.argmin(self.costs))]

    @property
    def fit(self) -> ArxFit:
        """The fit with that delay."""
        return self.fits[int(np.argmin(self.costs))]


def choose_delay(
    signal: np.ndarray,
    output: np.ndarray,
    *,
    order: int,
    delays: Iterable[int],
    period: float,
) -> DelayChoice:
    """Fit an ARX model with each delay and choose the one of the smallest J(d).

    The longer the delay the fewer samples can be fitted; so that every J is a sum over the same
    samples, those that the longest delay leaves.

    Parameters
    ----------
    signal, output : ndarray [N]
        As for `identification.arx.fit_arx`.
    order : int
    delays : iterable of int
        [samples]
    period : float
        [s]

    Raises
    ------
    InputError
        There is no delay to try, one is no whole number of samples, or as for `fit_arx`.

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
    tried = tuple(whole_number("choice of the delay, delays", each, 0) for each in delays)
    if not tried:
        raise InputError(
            "choice of the delay, delays", [], "delays to try", "give some, as range(9)"
        )
    longest = max(tried)
    fits = tuple(
        fit_arx(
            signal[longest - delay :], output[longest - delay :],
            order=order, delay=delay, period=period,
        )
        for delay in tried
    )  # fmt: skip
    return DelayChoice(tried, np.array([fit.cost for fit in fits]), fits)
