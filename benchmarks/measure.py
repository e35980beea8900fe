"""Interleaved timing: every way in every round, so that a slow minute is slow for all."""

from __future__ import annotations

import contextlib
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Way:
    """One way to solve the problem.

    Parameters
    ----------
    name : str
    run : callable
        Solves it once.
    calls : int
        Calls in one round; the round counts their median.
    """

    name: str
    run: Callable[[], object]
    calls: int = 1


@dataclass(frozen=True)
class Spread:
    """A median over the rounds, with the smallest and the largest value seen."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Return the spread of some values."""
        return cls(statistics.median(values), min(values), max(values))

    def times(self, factor: float) -> Spread:
        """Return the spread of values that are `factor` times as large."""
        return Spread(self.median * factor, self.low * factor, self.high * factor)

    def inverse(self, numerator: float) -> Spread:
        """Return the spread of `numerator` divided by the values."""
        return Spread(numerator / self.median, numerator / self.high, numerator / self.low)


@dataclass(frozen=True)
class Timings:
    """Seconds of every way in every round."""

    seconds: dict[str, list[float]]

    def of(self, name: str) -> Spread:
        """Return the seconds of one way."""
        return Spread.of(self.seconds[name])

    def ratio(self, numerator: str, denominator: str) -> Spread:
        """Return seconds of one way over those of another, each pair from the same round."""
        pairs = zip(self.seconds[numerator], self.seconds[denominator], strict=True)
        return Spread.of([a / b for a, b in pairs])


def interleave(
    ways: Sequence[Way],
    rounds: int,
    *,
    warm_up: bool = True,
    timed: Callable[[Callable[[], object]], float] | None = None,
) -> Timings:
    """Time all ways in each round, in an order that moves on by one from round to round.

    `timed` runs one and returns its seconds; left out, those that went by.
    """
    timed = timed or _once
    if warm_up:
        for way in ways:
            way.run()
    seconds: dict[str, list[float]] = {way.name: [] for way in ways}
    for number in range(rounds):
        first = number % len(ways)
        for way in [*ways[first:], *ways[:first]]:
            seconds[way.name].append(statistics.median(timed(way.run) for _ in range(way.calls)))
    return Timings(seconds)


def _once(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def on_one_core() -> contextlib.AbstractContextManager[None]:
    """Keep this thread, and the threads that it starts meanwhile, on one processor."""
    return on_cores(1)


@contextlib.contextmanager
def on_cores(count: int) -> Iterator[None]:
    """Keep this thread, and the threads that it starts meanwhile, on so many processors."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, set(sorted(allowed)[-count:]))
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)
