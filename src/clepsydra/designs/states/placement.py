"""Gains that place the eigenvalues of a sampled loop or of an observer."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from numbers import Complex

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable

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
    from scipy.signal import place_poles

    wanted = checked_poles(poles, len(held), place)
    A = (held - np.eye(len(held))) / period * sizes / sizes[:, None]
    B = moved / period * moves / sizes[:, None]
    _check_reached(A, B, period)
    rank = int(np.linalg.matrix_rank(B))
    rates = (wanted - 1.0) / period
    _check_multiplicity(rates, rank, place)
    with warnings.catch_warnings():
        # That the eigenvectors could be more orthogonal still is no fault; the poles are checked.
        warnings.simplefilter("ignore", UserWarning)
        try:
            gain = place_poles(A, B, rates).gain_matrix
        except ValueError as error:
            raise NotApplicable(f"the poles cannot be placed: {error}") from error
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
    listed = list(poles) if isinstance(poles, (list, tuple, np.ndarray)) else None
    numbers = listed is not None and all(
        isinstance(pole, Complex) and not isinstance(pole, bool) for pole in listed
    )
    if listed is None or not numbers or len(listed) != count:
        remedy = "give one for each state of the sampled model"
        raise InputError(place, listed if numbers else poles, f"{count} numbers", remedy)
    values = np.array(listed, complex)
    if not np.all(np.abs(values) < 1.0):
        raise InputError(
            place, listed, "numbers inside the unit circle, z = e^(sT)", "choose stable poles"
        )
    unpaired = np.sort_complex(values) - np.sort_complex(values.conj())
    if np.abs(unpaired).max(initial=0.0) > 1e-12:
        raise InputError(
            place, listed, "each complex pole with its conjugate", "add what is missing"
        )
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
            raise InputError(
                place,
                f"one pole {same} times",
                f"each at most {rank} times, the number of independent inputs",
                "move them apart a little",
            )


def _distance(found: np.ndarray, wanted: np.ndarray) -> float:
    """Return the largest distance between the poles, each taken with its own partner."""
    from scipy.optimize import linear_sum_assignment

    distances = np.abs(found[:, None] - wanted)
    rows, columns = linear_sum_assignment(distances)
    return float(distances[rows, columns].max(initial=0.0))
