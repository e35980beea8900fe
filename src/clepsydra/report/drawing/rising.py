"""The rising numbers that lie nearest to given ones."""

from __future__ import annotations

from collections.abc import Iterable


def nearest_rising(wanted: Iterable[float]) -> list[float]:
    """Return numbers that never fall, with the least sum of squares from those that are wanted.

    Neighbours in the wrong order share their mean (pool adjacent violators, Ayer et al. 1955,
    doi:10.1214/aoms/1177728423).

    Examples
    --------
    >>> nearest_rising([1.0, 4.0, 2.0, 3.0, 7.0])
    [1.0, 3.0, 3.0, 3.0, 7.0]
    """
    pools: list[tuple[float, int]] = []  # sum and count
    for number in wanted:
        total, count = number, 1
        while pools and pools[-1][0] * count >= total * pools[-1][1]:
            before, more = pools.pop()
            total, count = before + total, more + count
        pools.append((total, count))
    return [total / count for total, count in pools for _ in range(count)]
