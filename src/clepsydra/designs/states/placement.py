"""Gains that place the eigenvalues of a sampled loop or of an observer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from numbers import Complex

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.states.bessel_filter import bessel_poles, bessel_radius
from clepsydra.designs.states.robust_assignment import assigned_gain
from clepsydra.linear.assignment import cheapest_assignment

#: A mode is out of reach where the inputs move it by less than this share.
_UNREACHED = 1e-10
#: The poles found must be those asked for to this share of the fastest rate.
_ACCURACY = 1e-5


def placed_gain(
    held: np.ndarray,
    moved: np.ndarray,
    poles: Sequence[complex] | np.ndarray,
    sizes: np.ndarray,
    moves: np.ndarray,
    period: float,
    place: str = "poles",
) -> np.ndarray:
    """Return F with which Φ − Γ F has the given eigenvalues.

    With more inputs than one the freedom left is used for eigenvectors that are as orthogonal
    as possible (Tits and Yang). It is solved for (Φ − I)/T, whose eigenvalues (z − 1)/T stay
    apart however fast the sampling is.

    Parameters
    ----------
    held, moved : ndarray [n, n], [n, m]
        Φ and Γ.
    poles : sequence of complex [n]
        Eigenvalues z, inside the unit circle, with their conjugates.
    sizes, moves : ndarray [n], [m]
        Ranges of the states and of the inputs, in which they are compared.
    period : float
        T, the sampling period [s].
    place : str
        What the poles were asked for as.

    Raises
    ------
    NotApplicable
        A mode is out of reach, or the poles cannot be placed accurately.
    InputError
        The poles are not n numbers inside the unit circle with their conjugates, or one stands
        more often than there are inputs.

    References
    ----------
    A. L. Tits and Y. Yang, Globally convergent algorithms for robust pole assignment by state
    feedback, IEEE Transactions on Automatic Control 41(10), 1996, 1432-1452,
    doi 10.1109/9.539425.

    Examples
    --------
    >>> one = np.eye(1)
    >>> float(placed_gain(one, 0.5 * one, [0.8], one[0], one[0], 1.0)[0, 0].round(9))
    0.4
    """
    wanted = checked_poles(poles, len(held), place)
    A = (held - np.eye(len(held))) / period * sizes / sizes[:, None]
    B = moved / period * moves / sizes[:, None]
    _check_reached(A, B, period)
    rank = int(np.linalg.matrix_rank(B))
    rates = (wanted - 1.0) / period
    _check_multiplicity(rates, rank, place)
    try:
        gain = assigned_gain(A, B, rates)
    except np.linalg.LinAlgError as error:
        reason = f"the poles cannot be placed, for inputs or modes are too much alike ({error})"
        raise NotApplicable(reason) from error
    if _distance(np.linalg.eigvals(A - B @ gain), rates) > _ACCURACY * np.abs(rates).max():
        raise NotApplicable("the poles cannot be placed accurately")
    placed: np.ndarray = moves[:, None] * gain / sizes
    return placed


def checked_poles(poles: Sequence[complex] | np.ndarray, count: int, place: str) -> np.ndarray:
    """Return the poles as an array, refused where they are none of a stable sampled loop.

    Raises
    ------
    InputError
        They are not `count` numbers inside the unit circle, each with its conjugate.

    Examples
    --------
    >>> checked_poles([0.5, 0.5 + 0.1j], 2, "poles")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: poles: got [0.5, (0.5+0.1j)], expected each complex pole \
with its conjugate; add what is missing.
    """
    listed = list(poles) if isinstance(poles, (list, tuple, np.ndarray)) else []
    numbers = all(isinstance(pole, Complex) and not isinstance(pole, bool) for pole in listed)
    if not numbers or len(listed) != count:
        remedy = "give one for each state of the sampled model"
        raise InputError(place, (numbers and listed) or poles, f"{count} numbers", remedy)
    values = np.array(listed, complex)
    if not np.all(np.abs(values) < 1.0):
        expected = "numbers inside the unit circle, z = e^(sT)"
        raise InputError(place, listed, expected, "choose stable poles")
    unpaired = np.sort_complex(values) - np.sort_complex(values.conj())
    if np.abs(unpaired).max(initial=0.0) > 1e-12:
        expected = "each complex pole with its conjugate"
        raise InputError(place, listed, expected, "add what is missing")
    return values


def _check_reached(A: np.ndarray, B: np.ndarray, period: float) -> None:
    """Refuse a mode that no input moves, by Popov, Belevitch and Hautus."""
    n = len(A)
    for rate in np.linalg.eigvals(A):
        test = np.hstack([A - rate * np.eye(n), B * np.abs(A).max(initial=1e-300)])
        test = test / np.maximum(np.linalg.norm(test, axis=1, keepdims=True), 1e-300)
        if np.linalg.svd(test, compute_uv=False)[-1] < _UNREACHED:
            pole = 1.0 + rate * period
            near = abs(pole - 1.0) < 1e-9
            time = np.inf if near or abs(pole) == 0.0 else -period / np.log(abs(pole))
            lasting = "that integrates" if np.isinf(time) else f"of {time:.3g} s"
            raise NotApplicable(f"a mode {lasting} is out of reach, so that its pole stays")


def _check_multiplicity(rates: np.ndarray, rank: int, place: str) -> None:
    for rate in rates:
        same = int(np.sum(np.abs(rates - rate) < 1e-9 * np.abs(rates).max()))
        if same > rank:
            expected = f"each at most {rank} times, the number of independent inputs"
            raise InputError(place, f"one pole {same} times", expected, "move them apart a little")


def _distance(found: np.ndarray, wanted: np.ndarray) -> float:
    """Return the largest distance between the poles, each taken with its own partner."""
    distances = np.abs(found[:, None] - wanted)
    return max((float(distances[pair]) for pair in cheapest_assignment(distances)), default=0.0)


#: A mode slower than the pattern by less than this share counts as fast enough.
_SAME = 1e-6


def slow_modes_gain(
    held: np.ndarray,
    moved: np.ndarray,
    bandwidth: float,
    sizes: np.ndarray,
    moves: np.ndarray,
    period: float,
) -> np.ndarray:
    """Return F with which the slow eigenvalues of Φ − Γ F have Bessel's pattern.

    To slow a fast mode down costs gain and robustness and is good for nothing. So the k slowest
    modes are moved, where k is the largest number of modes that are all slower than every pole
    of the pattern of order k. F sees nothing but their part of the state, Zᵀ x with an
    orthonormal basis Z of their left invariant subspace, and the others keep their poles.

    Parameters
    ----------
    held, moved : ndarray [n, n], [n, m]
        Φ and Γ.
    bandwidth : float
        Of the pattern [rad/s].
    sizes, moves : ndarray [n], [m]
        Ranges of the states and of the inputs, in which they are compared.
    period : float
        The sampling period [s].

    Raises
    ------
    NotApplicable
        A slow mode is out of reach, or the poles cannot be placed accurately.

    Examples
    --------
    Modes of 100 s and 1 s; a pattern for 0.1 rad/s moves the first alone:

    >>> held = np.diag(np.exp([-0.01, -1.0]))
    >>> sizes = np.ones(2), np.ones(1)
    >>> gain = slow_modes_gain(held, np.ones((2, 1)), 0.1, *sizes, 1.0)
    >>> np.sort(np.log(np.linalg.eigvals(held - np.ones((2, 1)) @ gain))).round(9)
    array([-1. , -0.1])
    """
    from scipy.linalg import schur

    scaled = held * sizes / sizes[:, None]
    rates = np.sort(_rates(np.linalg.eigvals(scaled), period))
    count = 0
    for order in range(len(rates), 0, -1):
        radius = bessel_radius(order) * bandwidth
        # A pair of complex modes is not torn apart.
        torn = order < len(rates) and rates[order] <= rates[order - 1] * (1.0 + _SAME)
        if rates[order - 1] < radius * (1.0 - _SAME) and not torn:
            count = order
            break
    if not count:
        return np.zeros((moved.shape[1], len(held)))
    limit = rates[count - 1] * (1.0 + 0.5 * _SAME)

    def is_slow(real: float, imaginary: float) -> bool:
        return bool(_rates(np.array([complex(real, imaginary)]), period)[0] <= limit)

    # Φᵀ Z = Z T, so that w = Zᵀ x has w⁺ = Tᵀ w + Zᵀ Γ u.
    form, basis, found = schur(scaled.T, output="real", sort=is_slow)
    Z = basis[:, :found]
    poles = bessel_poles(found, bandwidth, period)
    reduced = Z.T @ (moved / sizes[:, None])
    part, ones = form[:found, :found].T, np.ones(found)
    gain = placed_gain(part, reduced, poles, ones, moves, period)
    return np.asarray(gain @ Z.T / sizes)


def _rates(eigenvalues: np.ndarray, period: float) -> np.ndarray:
    """Return |s| of z = e^(sT) [rad/s]."""
    smallest = np.maximum(np.abs(eigenvalues), np.finfo(float).tiny)
    logarithm = np.log(smallest) + 1j * np.angle(eigenvalues)
    rates: np.ndarray = np.abs(logarithm) / period
    return rates


def correction(
    placing: Callable[..., np.ndarray],
    held: np.ndarray,
    shown: np.ndarray,
    wanted: Sequence[complex] | np.ndarray | float,
    sizes: np.ndarray,
    spans: np.ndarray,
    period: float,
) -> np.ndarray:
    """Return M of the current observer whose error's poles are placed, as the dual of a gain.

    The eigenvalues of (I − M C) Φ are those of Φᵀ − (C Φ)ᵀ Mᵀ.

    Parameters
    ----------
    placing : callable
        `placed_gain` for given poles, or `slow_modes_gain` for a bandwidth.
    held, shown : ndarray [N, N], [p, N]
        Φ and C.
    wanted : sequence of complex [N], or float
        Poles, or the bandwidth [rad/s].
    sizes, spans : ndarray [N], [p]
        Ranges of the states and of the measurements.
    period : float
        [s]

    Raises
    ------
    NotApplicable
        The measurements do not show a mode, or it cannot be placed accurately.

    References
    ----------
    D. G. Luenberger, Observing the state of a linear system, IEEE Transactions on Military
    Electronics 8(2), 1964, 74-80, doi 10.1109/TME.1964.4323124.
    """
    C = shown / spans[:, None]
    try:
        dual = placing(held.T, (C @ held).T, wanted, 1.0 / sizes, np.ones(len(C)), period)
    except NotApplicable as refusal:
        # What the placement says of the inputs of the dual process is said of the measurements.
        reason = refusal.reason.replace("out of reach", "not shown by the measurements")
        raise NotApplicable(reason) from refusal
    found: np.ndarray = dual.T / spans
    return found
