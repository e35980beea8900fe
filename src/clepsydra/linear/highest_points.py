"""The highest points of curves over frequency, looked for side by side, and where to look."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# A maximum that can rise by less than this share is found: nine digits, and four of its place.
_RISE = 1e-9
# A maximum is looked at again at so many points between its neighbours.
_POINTS = 21
# Each look is ten times closer: after so many, neighbours differ in their last digits only.
_LOOKS = 16
_PER_DECADE = 8
# Each pole turns the phase by half a turn; so many frequencies follow it.
_PER_POLE = 8
# So far beyond the poles, and ten times farther, the curve is the one at zero or at infinity.
_BEYOND = np.array([1e2, 1e3])
# Nearer to each other than this share of the least damping ratio, frequencies are one.
_APART = 1e-3


def highest_points(
    curves: Callable[[np.ndarray, np.ndarray], np.ndarray],
    grids: np.ndarray,
    known: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the maximum over frequency of each of some curves.

    Every maximum on a grid that can be the highest is looked at more closely between its
    neighbours, and so on with what is seen there. A parabola through three points rises above
    the middle one by an eighth of the drop to the lower side at most; half of it is allowed.

    Parameters
    ----------
    curves : function
        Of frequencies [r, l] and the curve that each row is of [r] to values [r, l], none below
        zero.
    grids : ndarray [k, l]
        Of each curve frequencies above zero [rad/s], none lower than that before it and close
        enough to show every maximum.
    known : ndarray [k]
        A value of each curve, such as that at rest; only a higher one is looked for.

    Returns
    -------
    ndarray [k], ndarray [k]
        Values, to nine digits, and frequencies, to four [rad/s]; not a number where none is
        higher than the one that was known.

    Examples
    --------
    The resonances 1/(s² + 2 ζ s + 1) with ζ = 0.1 and 0.2:

    >>> damping, grid = np.array([[0.1], [0.2]]), np.geomspace(0.1, 10, 9)
    >>> values, at = highest_points(lambda w, of: 1.0 / abs(1.0 - w**2 + 2j * damping[of] * w),
    ...                             np.stack([grid, grid]), np.ones(2))
    >>> values.round(6), at.round(3)
    (array([5.025189, 2.551552]), array([0.99 , 0.959]))
    """
    best, at = np.array(known), np.full(len(known), np.nan)
    rows, of = np.log(grids), np.arange(len(grids))
    for _ in range(_LOOKS):
        frequencies = np.exp(rows)
        values = curves(frequencies, of)
        for row in np.flatnonzero(values.max(axis=1) > best[of]):
            column = values[row].argmax()
            if values[row, column] > best[of[row]]:  # of several rows of one curve the highest
                best[of[row]], at[of[row]] = values[row, column], frequencies[row, column]
        rows, of = _closer(rows, of, values, best)
        if not len(of):
            break
    return best, at


def _closer(
    rows: np.ndarray, of: np.ndarray, values: np.ndarray, best: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows around the maxima that can rise above the best, and the curve of each."""
    tops = np.ones(values.shape, bool)
    tops[:, 1:] &= values[:, 1:] >= values[:, :-1]
    tops[:, :-1] &= values[:, :-1] >= values[:, 1:]
    row, column = np.nonzero(tops)
    low, high = np.maximum(column - 1, 0), np.minimum(column + 1, rows.shape[1] - 1)
    top = values[row, column]
    drop = top - np.minimum(values[row, low], values[row, high])
    higher = top + drop / 2.0 > best[of[row]] * (1.0 + _RISE)
    row, low, high = row[higher], rows[row, low][higher], rows[row, high][higher]
    steps = (high - low)[:, None] / (_POINTS - 1)
    closer = np.hstack([steps * np.arange(_POINTS - 1) + low[:, None], high[:, None]])
    return closer, of[row]


def frequencies_of(poles: np.ndarray) -> np.ndarray:
    """Return frequencies that show every maximum of rational responses with these poles.

    Eight a decade, and at equal steps of the phase that each pole turns: so they stand close
    around a resonance, and where many poles turn the phase fast.

    Parameters
    ----------
    poles : ndarray [k, n], complex
        Of k responses, none at zero [rad/s].

    Returns
    -------
    ndarray [k, l]
        Rising [rad/s], above zero; the last stands several times where others have more.
    """
    sizes = np.abs(poles)
    low, high = sizes.min(axis=1, keepdims=True) / 10.0, sizes.max(axis=1, keepdims=True) * 10.0
    steps = np.ceil(_PER_DECADE * np.log10(high / low))
    decades = low * (high / low) ** np.minimum(np.arange(steps.max() + 1.0) / steps, 1.0)
    # Those of each pole stand between those of the others: equal poles share one fast turn.
    shift = (np.arange(poles.shape[1])[:, None] + 0.5) / poles.shape[1]
    turns = np.pi * ((np.arange(_PER_POLE) + shift) / _PER_POLE - 0.5)
    around = poles.imag[..., None] + np.abs(poles.real)[..., None] * np.tan(turns)
    around = np.clip(around.reshape(len(poles), -1), low, high)
    grids = np.concatenate([low * 10.0 / _BEYOND, decades, around, high / 10.0 * _BEYOND], axis=1)
    grids.sort(axis=1)
    # Between two that agree but for rounding no slope is seen.
    apart = _APART * np.min(np.abs(poles.real) / sizes, axis=1, keepdims=True)
    grids[np.diff(grids, axis=1, prepend=0.0) <= apart * grids] = np.inf
    grids.sort(axis=1)
    grids = grids[:, : np.isfinite(grids).sum(axis=1).max()]
    return np.asarray(np.minimum(grids, high / 10.0 * _BEYOND[-1]))
