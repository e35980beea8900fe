"""How little has to change in a model before some mode escapes its inputs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# The lower bound is raised to this share of the distance, as far as the evaluations last.
_SHARP = 0.99
_MOST = 20_000
_STARTS = 5
# Where the square of the height falls by less than this share of height times step, it is lowest.
_FLAT = 1e-8
_STEPS = 200
# Curvature that is taken for flat; that of a square is 2 at most.
_LEAST = 1e-8
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

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return them at points of the plane."""
        found = np.broadcast_to(self._whole, (*np.shape(points), *self._whole.shape)).copy()
        found[..., self._states, self._states] = self._diagonal - np.expand_dims(points, -1)
        return found

    def local(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return at each point σ_min², its slope, and the step of Newton's method downhill.

        Slope and step are complex numbers of the plane. In the basis U of left singular vectors
        [A - s I, B] [·]ᴴ changes by H = -(G + Gᴴ) with the real part of s and i (G - Gᴴ) with the
        imaginary part, G = Uᴴ (A - s I) U, and its second derivatives are 2 I and none.
        """
        left, sizes, right = np.linalg.svd(self.at(points), full_matrices=False)
        squares = sizes**2
        G = sizes[..., None] * (right[..., : len(self._states)] @ left)
        row, column = G[..., -1, :], G[..., :, -1].conj()
        H = np.stack([-(row + column), 1j * (row - column)], axis=-2)
        slopes = H[..., -1].real
        apart = np.finfo(float).eps * squares[..., :1]  # as near as two can be told apart
        above = np.maximum(squares[..., :-1] - squares[..., -1:], apart)
        others = H[..., :-1] / np.sqrt(above)[..., None, :]
        curvature = 2.0 * (np.eye(2) - (others @ others.conj().swapaxes(-1, -2)).real)
        values, axes = np.linalg.eigh(curvature)
        along = (axes.swapaxes(-1, -2) @ slopes[..., None])[..., 0]
        steps = -(axes @ (along / np.maximum(np.abs(values), _LEAST))[..., None])[..., 0]
        return squares[..., -1], slopes @ [1.0, 1.0j], steps @ [1.0, 1.0j]

    def heights(self, points: np.ndarray) -> np.ndarray:
        """Return σ_min at each point, in blocks, since all at once are gigabytes."""
        size = max(1, _BLOCK // self._whole.size)
        blocks = [points[first : first + size] for first in range(0, len(points), size)]
        return np.concatenate(
            [np.linalg.svd(self.at(each), compute_uv=False)[..., -1] for each in blocks]
        )


def _descend(tests: _Tests, starts: np.ndarray, rounding: float) -> tuple[float, complex]:
    """Return the lowest place found from the starts, and from none of them uphill.

    With the left singular vector u of σ_min, the square of σ_min is nowhere above that of
    uᴴ [A - s I, B], a paraboloid which it touches where u was found, so that to step to its lowest
    point, s = uᴴ A u, is always downhill. Newton's step, with the exact curvature of σ_min², is
    taken where it leads lower.
    """
    heights = tests.heights(starts)
    order = np.argsort(heights)[:_STARTS]
    best, root = float(heights[order[0]]), complex(starts[order[0]])
    if best <= rounding:
        return best, root
    places = starts[order]
    squares, slopes, steps = tests.local(places)
    for _ in range(_STEPS):
        moving = np.abs(slopes) > _FLAT * best
        if not moving.any():
            break
        tried = np.array([places + steps, places - slopes / 2.0])
        found = tests.local(tried)
        lower, each = np.argmin(found[0], axis=0), np.arange(len(places))
        moving &= found[0][lower, each] < squares
        if not moving.any():
            break
        places = np.where(moving, tried[lower, each], places)
        squares, slopes, steps = (
            np.where(moving, new[lower, each], old)
            for new, old in zip(found, (squares, slopes, steps), strict=True)
        )
    heights = tests.heights(places)
    lowest = int(np.argmin(heights))
    if heights[lowest] < best:
        return float(heights[lowest]), complex(places[lowest])
    return best, root
