"""Tasks that share the processors, each result as soon as it is there."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


def side_by_side(
    run: Callable[[Task], Result], tasks: Sequence[Task], workers: int
) -> Iterator[tuple[Task, Result]]:
    """Yield each task with its result, in the order in which they end.

    Parameters
    ----------
    run : callable
        Of a module, for other processes.
    workers : int
        Processes that share the tasks; with one it is this one.

    Examples
    --------
    >>> list(side_by_side(len, ["one", "three"], 1))
    [('one', 3), ('three', 5)]
    """
    if (workers := min(workers, len(tasks))) <= 1:
        yield from ((task, run(task)) for task in tasks)
        return
    # Forked processes would share locks of threads that are not there.
    pool = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))
    try:
        futures = {pool.submit(run, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures[future], future.result()
    finally:
        pool.shutdown(cancel_futures=True)
