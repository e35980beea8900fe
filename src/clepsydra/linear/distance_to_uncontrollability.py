"""How little has to change in a model before some mode escapes its inputs."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

# The lower bound is raised to this share of the distance, as far as the evaluations last.
_SHARP = 0.99
_MOST = 20_000
_STARTS = 5
# To this share of the height minima are compared, and the lowest is found.
_ROUGH, _FINE = 1e-6, 1e-12


class Distance(NamedTuple):
    """The distance of (A, B) to the nearest uncontrollable pair.

    Parameters
    ----------
    value : float
        The smallest σ_min([A - s I, B]) found, an upper bound that is attained [unit of A].
    at_least : float
        A proven lower bound [unit of A].
    root : complex
        The mode of the nearest uncontrollable pair [unit of A].
    """

    value: float
    at_least: float
    root: complex


def distance_to_uncontrollability(A: np.ndarray, B: np.ndarray) -> Distance:
    """Return min over complex s of σ_min([A - s I, B]), the spectral-norm distance.

    Unlike the margins of the modes it counts that a change of A moves the modes too, so it is
    never above the smallest of these. The plane is searched by halving squares: σ_min changes
    by no more than s does, so a square whose centre stands high enough holds no minimum, and
    what is left bounds the distance from below. For observability give Aᵀ and Cᵀ.

    Parameters
    ----------
    A, B : ndarray [n, n], [n, m]
        With states and inputs as shares of their ranges (`in_ranges`), so that they compare.

    Returns
    -------
    Distance
        Its two bounds within one percent, unless the distance is next to nothing.

    References
    ----------
    R. Eising, Between controllable and uncontrollable, Systems & Control Letters, 1984. M. Gu,
    New methods for estimating the distance to uncontrollability, SIAM Journal on Matrix
    Analysis and Applications, 2000. J. V. Burke, A. S. Lewis and M. L. Overton, Pseudospectral
    components and the distance to uncontrollability, SIAM Journal on Matrix Analysis and
    Applications 26, 2004, 350-361.

    Examples
    --------
    One state is never uncontrollable but for B = 0, so the distance is |B|:

    >>> distance_to_uncontrollability(np.array([[-0.02]]), np.array([[0.3]])).value
    0.3
    """
    n = len(A)
    whole, diagonal, states = np.hstack([A, B]).astype(complex), A.diagonal(), np.arange(n)

    def sizes(points: np.ndarray) -> np.ndarray:
        tests = np.empty((*points.shape, *whole.shape), complex)
        tests[...] = whole
        tests[..., states, states] = diagonal - points[..., None]
        return np.asarray(np.linalg.svd(tests, compute_uv=False)[..., -1])

    starts = np.linalg.eigvals(A).astype(complex)
    value, root = _descend(sizes, starts)
    rounding = 1e-14 * float(np.linalg.norm(np.hstack([A, B]), 2))
    if value <= rounding:  # nothing below it could be told from it
        return Distance(value, 0.0, root)
    # Where σ_min(A - s I, B) ≤ d, s lies within d of the numerical range of A.
    real = np.linalg.eigvalsh((A + A.T) / 2.0)
    turning = float(np.linalg.norm((A - A.T) / 2.0, 2))
    low, high = real[0] - value, real[-1] + value
    top = turning + value
    side = max((high - low) / 8.0, top / 8.0, rounding)
    reals, imaginaries = np.arange(low, high + side, side), np.arange(0.0, top + side, side)
    centres = (reals[:, None] + 1j * imaginaries).ravel() + (1.0 + 1.0j) * side / 2.0
    used, bound = 0, 0.0
    while len(centres):
        heights = sizes(centres)
        used += len(centres)
        lowest = np.argsort(heights)[:_STARTS]
        found = _descend(sizes, centres[lowest])
        if found[0] < value:
            value, root = found
        below = heights - side / np.sqrt(2.0)
        left = below < _SHARP * value
        if not np.any(left):
            bound = _SHARP * value
            break
        bound = max(bound, float(below[left].min()))
        if used + 4 * int(left.sum()) > _MOST or side < rounding:
            break
        side /= 2.0
        quarters = np.array([-1.0 - 1.0j, -1.0 + 1.0j, 1.0 - 1.0j, 1.0 + 1.0j]) * side / 2.0
        centres = (centres[left][:, None] + quarters).ravel()
    return Distance(value, bound, root)


def _descend(
    sizes: Callable[[np.ndarray], np.ndarray], starts: np.ndarray
) -> tuple[float, complex]:
    """Return the lowest place found from the starts, and from none of them uphill."""
    from scipy.optimize import minimize

    def lowered(place: complex, accuracy: float) -> complex:
        found = minimize(
            lambda place: float(sizes(np.array(complex(*place)))),
            [place.real, place.imag],
            method="Nelder-Mead",
            options={"xatol": 1e3 * accuracy * max(abs(place), best), "fatol": accuracy * best},
        )
        return complex(*found.x)

    heights = sizes(starts)
    best, root = float(heights.min()), complex(starts[int(np.argmin(heights))])
    # All starts are followed as far as it takes to tell their minima apart, and one to the end.
    ends = np.array([lowered(start, _ROUGH) for start in starts[np.argsort(heights)[:_STARTS]]])
    end = lowered(ends[int(np.argmin(sizes(ends)))], _FINE)
    found = float(sizes(np.array(end)))
    return (found, end) if found < best else (best, root)
