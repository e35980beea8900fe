"""Independent work on threads, which an interruption ends within about a second."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

_AT_MOST: ContextVar[int | None] = ContextVar("threads at most", default=None)
#: Set where nobody waits for what this thread computes any more.
_GIVEN_UP: ContextVar[threading.Event | None] = ContextVar("given up", default=None)


@contextmanager
def threads_at_most(count: int) -> Iterator[None]:
    """Let kernels that this thread runs within take no more threads than so many.

    Where others work on the same processors, threads of one's own only take turns with them.

    Examples
    --------
    >>> with threads_at_most(1):
    ...     available_threads()
    1
    """
    before = _AT_MOST.set(count)
    try:
        yield
    finally:
        _AT_MOST.reset(before)


def available_threads() -> int:
    """Return the number of processors that this process may use, see `threads_at_most` too."""
    if hasattr(os, "sched_getaffinity"):
        found = len(os.sched_getaffinity(0))
    else:
        found = os.cpu_count() or 1
    most = _AT_MOST.get()
    return found if most is None else min(found, most)


def in_threads(work: Callable[[int, int], Iterator[None]], count: int, threads: int) -> None:
    """Go through ``work(start, stop)`` so that 0 … count-1 is covered once, on some threads.

    Parameters
    ----------
    work : callable
        Works on a range of items, and gives control back now and then; must not depend on other
        ranges.
    count : int
        Number of items.
    threads : int
    """
    size = -(-count // threads)
    starts = range(0, count, size)
    if threads == 1 or len(starts) == 1:
        unwanted = _GIVEN_UP.get()
        for start in starts:
            for _ in work(start, min(start + size, count)):
                if unwanted is not None and unwanted.is_set():
                    raise CancelledError
        return
    given_up = threading.Event()

    def until_given_up(start: int) -> None:
        for _ in work(start, min(start + size, count)):
            if given_up.is_set():
                return

    # The thread that asks works too: to begin one takes as long as a short run.
    with ThreadPoolExecutor(len(starts) - 1) as pool:
        futures = [pool.submit(until_given_up, start) for start in starts[1:]]
        try:
            until_given_up(starts[0])
            for future in futures:
                future.result()
        except BaseException:
            given_up.set()
            for future in futures:
                future.cancel()
            raise


def side_by_side(work: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Yield the results of items in their order, several at work at a time, each on one thread.

    Each may compute and arrange arrays: while one arranges, another one computes. The first is done
    alone on all threads, so that what all need is made once. An interruption ends kernels at work
    as `in_threads` does, and leaves the others out.

    Examples
    --------
    >>> list(side_by_side(lambda item: item * item, range(5)))
    [0, 1, 4, 9, 16]
    """
    waiting, count = iter(items), available_threads()
    for first in waiting:
        yield work(first)
        break
    if count == 1:
        yield from map(work, waiting)
        return

    given_up = threading.Event()

    def alone(item: Item) -> Result:
        _GIVEN_UP.set(given_up)  # of this thread, which ends with the pool
        with threads_at_most(1):
            return work(item)

    with ThreadPoolExecutor(count) as pool:
        going: deque[Future[Result]] = deque()
        try:
            for item in waiting:
                going.append(pool.submit(alone, item))
                if len(going) > count:
                    yield going.popleft().result()
            while going:
                yield going.popleft().result()
        finally:
            given_up.set()
            for future in going:
                future.cancel()
