"""The Luenberger observer: an estimate whose error dies away with given poles."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.states.placement import placed_gain
from clepsydra.designs.states.slow_modes import place_slow_modes


def placed_correction(
    held: np.ndarray,
    shown: np.ndarray,
    poles: Sequence[complex] | np.ndarray,
    sizes: np.ndarray,
    spans: np.ndarray,
    period: float,
) -> np.ndarray:
    """Return M of the current observer with which (I − M C) Φ has the given eigenvalues.

    Φ − M (C Φ) is the dual of Φ − Γ F, so that it is placed as a feedback is
    (`designs.states.placement`).

    Parameters
    ----------
    held, shown : ndarray [N, N], [p, N]
        Φ and C.
    poles : sequence of complex [N]
    sizes, spans : ndarray [N], [p]
        Ranges of the states and of the measurements: they scale the numbers.
    period : float
        The sampling period [s].

    Raises
    ------
    NotApplicable
        The measurements do not show a mode, or the poles cannot be placed accurately.
    InputError
        The poles are not N numbers inside the unit circle with their conjugates, or one stands
        more often than there are measurements.

    References
    ----------
    D. G. Luenberger, An introduction to observers, IEEE Transactions on Automatic Control
    16(6), 1971, 596-602, doi 10.1109/TAC.1971.1099826.

    Examples
    --------
    x⁺ = 0.9 x, y = x and an error that halves in each sample: (1 − M) 0.9 = 0.5.

    >>> one = np.eye(1)
    >>> found = placed_correction(0.9 * one, one, [0.5], np.ones(1), np.ones(1), 1.0)
    >>> round(float(found[0, 0]), 9)
    0.444444444
    """

    def dual(A: np.ndarray, B: np.ndarray, s: np.ndarray, m: np.ndarray) -> np.ndarray:
        return placed_gain(A, B, poles, s, m, period, "observer_poles")

    return _corrected(held, shown, sizes, spans, dual)


def bessel_correction(
    held: np.ndarray,
    shown: np.ndarray,
    bandwidth: float,
    sizes: np.ndarray,
    spans: np.ndarray,
    period: float,
) -> np.ndarray:
    """Return M with which the slow modes of the estimate's error have Bessel's pattern.

    Errors that die away faster by themselves are left alone (`designs.states.slow_modes`).

    Parameters
    ----------
    held, shown, sizes, spans, period
        As for `placed_correction`.
    bandwidth : float
        Of the pattern [rad/s].

    Raises
    ------
    NotApplicable
        The measurements do not show a slow mode, or the poles cannot be placed accurately.

    Examples
    --------
    >>> one = np.eye(1)
    >>> found = bessel_correction(one, one, np.log(2.0), np.ones(1), np.ones(1), 1.0)
    >>> round(float(found[0, 0]), 9)
    0.5
    """

    def dual(A: np.ndarray, B: np.ndarray, s: np.ndarray, m: np.ndarray) -> np.ndarray:
        return place_slow_modes(A, B, bandwidth, s, m, period).gain

    return _corrected(held, shown, sizes, spans, dual)


def _corrected(
    held: np.ndarray,
    shown: np.ndarray,
    sizes: np.ndarray,
    spans: np.ndarray,
    placed: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    C = shown / spans[:, None]
    try:
        dual = placed(held.T, (C @ held).T, 1.0 / sizes, np.ones(len(C)))
    except NotApplicable as refusal:
        # What the placement says of the inputs of the dual process is said of the measurements.
        reason = refusal.reason.replace("out of reach", "not shown by the measurements")
        raise NotApplicable(reason) from refusal
    correction: np.ndarray = dual.T / spans
    return correction
