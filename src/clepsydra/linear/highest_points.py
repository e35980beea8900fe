"""The highest points of many curves over frequency, looked for side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

# A maximum that can rise by less than this share is found: nine digits, and four of its place.
_RISE = 1e-9
# A maximum is looked at again at so many points between its neighbours.
_POINTS = 21
# Each look is ten times closer: after so many, neighbours differ in their last digits only.
_LOOKS = 16


def highest_points(
    curves: Callable[[np.ndarray, np.ndarray], np.ndarray], grids: Sequence[np.ndarray]
) -> list[tuple[float, float]]:
    """Return the maximum of each curve over frequency, and where it stands.

    Every maximum on the grid that can be the highest of its curve is looked at more closely
    between its neighbours, and so on with what is seen there. A parabola through three points
    rises above the middle one by an eighth of the drop to the lower side at most; half of it is
    allowed.

    Parameters
    ----------
    curves : function
        Of which curves [l], by their places, and at which frequencies [l] to values [l], none
        below zero. What it says of one curve must not depend on the others.
    grids : sequence of ndarray
        Frequencies of each curve, rising, above zero [rad/s], close enough to show every maximum.

    Returns
    -------
    list of tuple of float
        The value, to nine digits, and the frequency, to four [rad/s].

    Examples
    --------
    The resonances 1/(s² + 2 ζ s + 1) with ζ = 0.1 and 0.2:

    >>> damping = np.array([0.1, 0.2])
    >>> found = highest_points(
    ...     lambda which, w: 1.0 / abs(1.0 - w**2 + 2j * damping[which] * w),
    ...     [np.geomspace(0.1, 10, 9), np.geomspace(0.1, 10, 12)])
    >>> [round(value, 6) for value, _ in found]
    [5.025189, 2.551552]
    """
    best = [(0.0, float(grid[0])) for grid in grids]
    which = np.arange(len(grids))
    # A shorter grid stays at its last frequency, where nothing rises any more.
    longest = max(map(len, grids), default=0)
    rows = np.log([np.append(grid, np.full(longest - len(grid), grid[-1])) for grid in grids])
    for _ in range(_LOOKS):
        frequencies = np.exp(rows)
        owners = np.repeat(which, rows.shape[1])
        values = curves(owners, frequencies.ravel()).reshape(rows.shape)
        highest = np.arange(len(rows)), values.argmax(axis=1)
        seen = zip(values[highest].tolist(), frequencies[highest].tolist(), strict=True)
        for curve, there in zip(which, seen, strict=True):
            best[curve] = max(best[curve], there)
        before = np.concatenate([values[:, :1], values[:, :-1]], axis=1)
        after = np.concatenate([values[:, 1:], values[:, -1:]], axis=1)
        reach = values + (values - np.minimum(before, after)) / 2.0
        known = np.array([best[curve][0] for curve in which])[:, None]
        tops = (values >= before) & (values >= after) & (reach > known * (1.0 + _RISE))
        row, column = np.nonzero(tops)
        if not row.size:
            break
        low = rows[row, np.maximum(column - 1, 0)]
        high = rows[row, np.minimum(column + 1, rows.shape[1] - 1)]
        steps = (high - low) / (_POINTS - 1)
        which = which[row]
        rows = np.append(steps * np.arange(_POINTS - 1)[:, None] + low, [high], axis=0).T
    return best
