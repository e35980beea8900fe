"""Trajectories thinned to what a picture resolves, without losing a peak."""

from __future__ import annotations

import numpy as np


def envelope(places: np.ndarray, values: np.ndarray, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a trajectory that a picture some columns wide can show.

    Of the points in one column only the first, the lowest, the highest and the last stay, in
    their order: a line through them covers the same column as a line through all.

    Parameters
    ----------
    places : ndarray [points]
        Rising places along the picture, in columns.
    values : ndarray [points]
        May hold numbers that are not finite; these stay where a column has no other.
    columns : int

    Returns
    -------
    places, values : ndarray [at most 4 * columns]

    Examples
    --------
    A thousand points of noise in two columns:

    >>> places = np.linspace(0.0, 2.0, 1000, endpoint=False)
    >>> values = np.sin(np.arange(1000.0))
    >>> thin, shown = envelope(places, values, 2)
    >>> len(thin), bool(shown.max() == values.max()), bool(shown.min() == values.min())
    (8, True, True)
    """
    if len(places) <= 4 * columns:
        return places, values
    column = np.floor(places - places[0]).astype(np.int64)
    first = np.flatnonzero(np.diff(column, prepend=-1))
    last = np.append(first[1:], len(places)) - 1
    counts = last - first + 1
    below, above = np.nan_to_num(values, nan=np.inf), np.nan_to_num(values, nan=-np.inf)
    least = np.flatnonzero(below == np.repeat(np.minimum.reduceat(below, first), counts))
    most = np.flatnonzero(above == np.repeat(np.maximum.reduceat(above, first), counts))
    lowest = least[np.searchsorted(least, first)]
    highest = most[np.searchsorted(most, last, side="right") - 1]
    kept = np.unique(np.concatenate([first, lowest, highest, last]))
    return places[kept], values[kept]
