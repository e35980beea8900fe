"""Independent work on threads, in parts small enough to be interrupted."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

#: Group-samples after which a part ends, so that a batch can be interrupted within about a
#: second; one group of lanes is never split.
_PART = 4_000_000


def available_threads() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_threads(
    work: Callable[[int, int], None], count: int, threads: int, *, cost: int = 1
) -> None:
    """Call ``work(start, stop)`` so that 0 … count-1 is covered once, on some threads.

    Parameters
    ----------
    work : callable
        Work on a range of items; must not depend on other ranges.
    count : int
        Number of items.
    threads : int
    cost : int
        Of one item, in samples: sets how many items make a part.
    """
    size = max(1, min(-(-count // threads), _PART // max(cost, 1)))
    starts = range(0, count, size)
    if threads == 1 or len(starts) == 1:
        for start in starts:
            work(start, min(start + size, count))
        return
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(work, start, min(start + size, count)) for start in starts]
        try:
            for future in futures:
                future.result()
        except BaseException:
            for future in futures:
                future.cancel()
            raise
