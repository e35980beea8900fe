"""How little has to change in a model before some mode escapes its inputs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# The lower bound is raised to this share of the distance, as far as the evaluations last.
_SHARP = 0.99
_MOST = 20_000
_STARTS = 5
# Where the height falls by less than this share of a step, it is lowest.
_FLAT = 1e-8
# So many entries have the matrices that are decomposed together [16 bytes each].
_BLOCK = 2**18
#: Above so many states the search would take minutes: each of up to `_MOST` points of the plane
#: costs work with the third power of the states.
MOST_STATES = 40


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
    tests = _Tests(A, B)
    starts = np.linalg.eigvals(A).astype(complex)
    rounding = 1e-14 * float(np.linalg.norm(np.hstack([A, B]), 2))
    value, root = _descend(tests, starts, rounding)
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
        heights = tests.heights(centres)
        used += len(centres)
        lowest = np.argsort(heights)[:_STARTS]
        found = _descend(tests, centres[lowest], rounding)
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


class _Tests:
    """The matrices [A - s I, B], whose rank Popov, Belevitch and Hautus ask for."""

    def __init__(self, A: np.ndarray, B: np.ndarray) -> None:
        self._whole = np.hstack([A, B]).astype(complex)
        self._diagonal, self._states = A.diagonal(), np.arange(len(A))

    def at(self, points: np.ndarray | complex) -> np.ndarray:
        """Return them at points of the plane."""
        found = np.broadcast_to(self._whole, (*np.shape(points), *self._whole.shape)).copy()
        found[..., self._states, self._states] = self._diagonal - np.expand_dims(points, -1)
        return found

    def heights(self, points: np.ndarray) -> np.ndarray:
        """Return σ_min at each point, in blocks, since all at once are gigabytes."""
        size = max(1, _BLOCK // self._whole.size)
        blocks = [points[first : first + size] for first in range(0, len(points), size)]
        return np.concatenate(
            [np.linalg.svd(self.at(each), compute_uv=False)[..., -1] for each in blocks]
        )


def _descend(tests: _Tests, starts: np.ndarray, rounding: float) -> tuple[float, complex]:
    """Return the lowest place found from the starts, and from none of them uphill."""
    from scipy.optimize import minimize

    heights = tests.heights(starts)
    order = np.argsort(heights)[:_STARTS]
    best, root = float(heights[order[0]]), complex(starts[order[0]])
    if best <= rounding:
        return best, root

    def squared(place: np.ndarray) -> tuple[float, np.ndarray]:
        # As a share of the best, and smooth also where it reaches zero: dσ = -Re(uᴴ v ds).
        left, sizes, right = np.linalg.svd(tests.at(best * complex(*place)), full_matrices=False)
        slope = -left[:, -1].conj() @ right[-1, : len(left)].conj()
        height = sizes[-1] / best
        return height**2, 2.0 * height * np.array([slope.real, -slope.imag])

    found = [
        minimize(squared, [start.real, start.imag], jac=True, options={"gtol": _FLAT}).x
        for start in starts[order] / best
    ]
    ends = best * np.array([complex(*place) for place in found])
    heights = tests.heights(ends)
    lowest = int(np.argmin(heights))
    if heights[lowest] < best:
        return float(heights[lowest]), complex(ends[lowest])
    return best, root
