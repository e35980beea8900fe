"""Tasks that share the processors, each result as soon as it is there."""

from __future__ import annotations

import multiprocessing
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


def side_by_side(
    run: Callable[[Task], Result], groups: Sequence[Sequence[Task]], workers: int
) -> Iterator[tuple[Task, Result]]:
    """Yield each task with its result, in the order in which they end.

    Tasks of one group keep what others of it need, and so stay in one process; one that has nothing
    else to do takes over the last of the longest group.

    Parameters
    ----------
    run : callable
        Of a module, for other processes.
    groups : sequence of sequence
        Of tasks.
    workers : int
        Processes that share the tasks; with one it is this one.

    Examples
    --------
    >>> list(side_by_side(len, [["one"], ["three", "four"]], 1))
    [('one', 3), ('three', 5), ('four', 4)]
    """
    if (workers := min(workers, sum(map(len, groups)))) <= 1:
        yield from ((task, run(task)) for group in groups for task in group)
        return
    unbegun = deque(deque(group) for group in groups if group)
    begun = [deque[Task]() for _ in range(workers)]
    # Forked processes would share locks of threads that are not there.
    context = multiprocessing.get_context("spawn")
    going: dict[Future[Result], tuple[int, Task]] = {}
    with ExitStack() as ended:
        pools = [ProcessPoolExecutor(1, context) for _ in range(workers)]
        for pool in pools:
            ended.callback(pool.shutdown, cancel_futures=True)
        free = list(range(workers))
        while True:
            for worker in free:
                if not begun[worker] and unbegun:
                    begun[worker] = unbegun.popleft()
                own, longest = begun[worker], max(begun, key=len)
                if longest:
                    task = own.popleft() if own else longest.pop()
                    going[pools[worker].submit(run, task)] = worker, task
            if not going:
                return
            done, _ = wait(going, return_when=FIRST_COMPLETED)
            for future in done:
                yield going[future][1], future.result()
            free = [going.pop(future)[0] for future in done]
