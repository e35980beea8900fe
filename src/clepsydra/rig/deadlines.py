"""Deadlines on a clock that nobody sets: when each period begins, and by how much it was missed."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

#: Who is later than so many periods, and this long, has slept: the periods are not made up for.
_SLEPT_PERIODS, _SLEPT = 5, 0.5
#: An event loop wakes up to a millisecond late; the last of a wait is slept through [s].
_EXACTLY = 0.002


@dataclass
class Deadlines:
    """The beginnings of periods, each at its place on the clock, however late the one before was.

    Parameters
    ----------
    period : float
        [s]
    now, sleep : callable, optional
        A clock [s], and how to wait for a time [s].
    first : float, optional
        When the first one begins, on that clock [s]; a period from now if left out.
    makes_up : bool
        Whether periods that were missed are made up for, but after a sleep. As a cyclic task of a
        PLC, who does not begins one late, and then the next that is still to come.

    Attributes
    ----------
    last : float
        When the last one was to begin [s].
    lateness : float
        Of the last one [s].
    missed : int
        Periods that were left out.

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
    first: float | None = None
    makes_up: bool = True

    def __post_init__(self) -> None:
        self._next = self.now() + self.period if self.first is None else self.first
        self.last, self.lateness, self.missed = self._next - self.period, 0.0, 0

    def wait(self) -> None:
        """Wait for the next one."""
        left = self._next - self.now()
        if left > 0.0:
            self.sleep(left)
        self._begin()

    async def wait_beside(self) -> None:
        """Wait for the next one, and let others go on meanwhile."""
        while (left := self._next - self.now()) > _EXACTLY:
            await asyncio.sleep(left - _EXACTLY)
        self.wait()

    def leave_out(self, periods: int = 0) -> int:
        """Leave out some periods, and those that have begun; return how many."""
        over = int((self.now() - self._next) // self.period) + 1
        left_out = max(periods, over)
        self._next += left_out * self.period
        return left_out

    def _begin(self) -> None:
        now = self.now()
        self.last, self.lateness = self._next, max(0.0, now - self._next)
        self._next += self.period
        slept = self.lateness > max(_SLEPT, _SLEPT_PERIODS * self.period)
        if slept or (now > self._next and not self.makes_up):
            left_out = int((now - self._next) // self.period) + 1
            self.missed += left_out
            self._next += left_out * self.period
