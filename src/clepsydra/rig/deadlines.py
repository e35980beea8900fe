"""Deadlines on a clock that nobody sets: when each period begins, and by how much it was missed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

#: Who is later than so many periods, and this long, has slept: the periods are not made up for.
_SLEPT_PERIODS, _SLEPT = 5, 0.5


@dataclass
class Deadlines:
    """The beginnings of periods, each at its place on the clock, however late the one before was.

    Parameters
    ----------
    period : float
        [s]
    now, sleep : callable, optional
        A clock [s], and how to wait for a time [s].

    Attributes
    ----------
    lateness : float
        Of the last one [s].
    missed : int
        Periods that were left out after a sleep.

    Examples
    --------
    >>> clock = iter([0.0, 0.1, 1.002, 1.9, 9.5, 9.6, 10.0])
    >>> deadlines = Deadlines(1.0, now=lambda: next(clock), sleep=lambda seconds: None)
    >>> for _ in range(3):
    ...     deadlines.wait()
    ...     print(round(deadlines.lateness, 3), deadlines.missed)
    0.002 0
    7.5 7
    0.0 7
    """

    period: float
    now: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep

    def __post_init__(self) -> None:
        self._next = self.now() + self.period
        self.lateness, self.missed = 0.0, 0

    def wait(self) -> None:
        """Wait for the next one."""
        left = self._next - self.now()
        if left > 0.0:
            self.sleep(left)
        now = self.now()
        self.lateness = max(0.0, now - self._next)
        self._next += self.period
        if self.lateness > max(_SLEPT, _SLEPT_PERIODS * self.period):
            left_out = int((now - self._next) // self.period) + 1
            self.missed += left_out
            self._next += left_out * self.period
