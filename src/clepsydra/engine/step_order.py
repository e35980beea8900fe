"""The order of a sample's steps: as soon as a processor could begin each of them.

A processor looks ahead by a few hundred instructions. What a law lists tank by tank then waits for
one tank's roots, one after the other, while the next tank's stand too far behind.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from clepsydra.engine.steps import Bounded, Required, Step, reads, statement_in, writes
from clepsydra.program.operation import LIBRARY, Operation
from clepsydra.program.program import Statement

#: Cycles until a result is there, and the unit that computes it, if it may be short of time. About
#: those of all processors since 2015; AMD's Zen 4 was measured.
_ADD, _MULTIPLY, _DIVIDE, _ANY = "add", "multiply", "divide", ""
_COSTS = {
    "constant": (0, _ANY),
    "add": (3, _ADD),
    "subtract": (3, _ADD),
    "minimum": (2, _ADD),
    "maximum": (2, _ADD),
    "multiply": (4, _MULTIPLY),
    "less": (4, _MULTIPLY),
    "less_equal": (4, _MULTIPLY),
    "equal": (4, _MULTIPLY),
    "not_equal": (4, _MULTIPLY),
    "divide": (13, _DIVIDE),
    "square_root": (21, _DIVIDE),
    "select": (2, _ANY),
    **dict.fromkeys(LIBRARY, (40, _MULTIPLY)),
}
_OTHER = (1, _ANY)
#: Statements with a body.
_LONG = (60, _MULTIPLY)
_FUSED = (4, _MULTIPLY)
#: Cycles of a root out of multiply-adds, and how many of them; by whether it may be endless. A bit
#: less than alone (35 and 11), which gave the fastest orders.
_REFINED, _MULTIPLY_ADDS = {False: 32, True: 40}, {False: 10, True: 13}
#: Lanes of a vector: alone it waits too long for an endless root, two side by side do not.
_VECTOR = 8
#: For how many cycles a lane of a root or quotient keeps the divider.
_BUSY = {"square_root": 2.0, "divide": 1.25}


@dataclass(frozen=True)
class Form:
    """What decides how long the steps of a sample take.

    Parameters
    ----------
    lanes : int
    refines : bool
        Whether bounded roots may be computed by multiply-adds.
    read_by : callable
        The values that a statement reads as it is printed.
    is_fused : callable
        Whether a statement is printed as a fused multiply-add.
    """

    lanes: int
    refines: bool
    read_by: Callable[[Statement], tuple[int, ...]]
    is_fused: Callable[[Statement], bool]

    def cost(self, step: Step) -> tuple[int, str]:
        """Return the cycles of a step and its unit."""
        if isinstance(step, Required):
            return _COSTS["add"]
        statement = statement_in(step)
        if statement is None:
            return _COSTS["constant"]
        if not isinstance(statement, Operation):
            return _LONG
        return _FUSED if self.is_fused(statement) else _COSTS.get(statement.code, _OTHER)

    def busy(self, step: Step) -> float:
        """Return for how many cycles a step keeps its unit from others."""
        statement = statement_in(step)
        if isinstance(statement, Operation) and statement.code in _BUSY:
            return _BUSY[statement.code] * self.lanes
        return max(self.lanes / _VECTOR, 0.5)  # two units, each half as wide as eight lanes


def soonest_first(steps: Sequence[Step], form: Form) -> list[Step]:
    """Return the steps as they would begin, each as soon as what it reads is there.

    Of those that wait for the same unit the one with the longest way to the end begins first. A
    bounded root becomes a refined one where multiply-adds give it before the divider would.

    Examples
    --------
    >>> slow, then, quick = (
    ...     Operation(1, "square_root", (0,)), Operation(2, "add", (1, 1)),
    ...     Operation(3, "multiply", (0, 0)),
    ... )
    >>> form = Form(1, False, lambda each: each.arguments, lambda each: False)
    >>> [step.target for step in soonest_first([slow, then, quick], form)]
    [1, 3, 2]
    """
    return _Schedule(steps, form).order()


class _Schedule:
    def __init__(self, steps: Sequence[Step], form: Form) -> None:
        self.steps, self.form = steps, form
        self.costs = [form.cost(step) for step in steps]
        origin = {value: n for n, step in enumerate(steps) for value in writes(step)}
        self.followers: dict[int, list[int]] = defaultdict(list)
        self.missing = [0] * len(steps)
        for n, step in enumerate(steps):
            for before in {origin[value] for value in reads(step, form.read_by) if value in origin}:
                self.followers[before].append(n)
                self.missing[n] += 1
        self.ways = self._ways()
        self.there = [0.0] * len(steps)
        #: When a unit is free, and what waits for it, longest way first.
        self.free: dict[str, float] = defaultdict(float)
        self.waiting: dict[str, list[tuple[int, int]]] = {_DIVIDE: [], _MULTIPLY: [], _ADD: []}
        self.coming = [(0.0, n) for n, missing in enumerate(self.missing) if not missing]
        self.begun: list[Step] = []

    def _ways(self) -> list[int]:
        """Return how long it takes from the beginning of each step to the end of all."""
        ways = [0] * len(self.steps)
        for n in reversed(range(len(self.steps))):
            ways[n] = self.costs[n][0] + max((ways[k] for k in self.followers[n]), default=0)
        return ways

    def order(self) -> list[Step]:
        now = 0.0
        while self.coming or any(self.waiting.values()):
            while self.coming and self.coming[0][0] <= now:
                _, n = heapq.heappop(self.coming)
                unit = self.costs[n][1]
                if unit == _ANY:
                    self._begin(n, now, self.costs[n][0])
                else:
                    heapq.heappush(self.waiting[unit], (-self.ways[n], n))
            if not self._beginning(now):
                now = min(self._next_times(), default=now)
        return self.begun

    def _next_times(self) -> Iterable[float]:
        yield from (self.free[unit] for unit, waiting in self.waiting.items() if waiting)
        if self.coming:
            yield self.coming[0][0]

    def _beginning(self, now: float) -> bool:
        """Begin what the units are free for; return whether anything was."""
        before = len(self.begun)
        self._refine(now)
        for unit, waiting in self.waiting.items():
            if waiting and self.free[unit] <= now:
                _, n = heapq.heappop(waiting)
                self.free[unit] = now + self.form.busy(self.steps[n])
                self._begin(n, now, self.costs[n][0])
        return len(self.begun) > before

    def _refine(self, now: float) -> None:
        """Give a root to the multiply-adds where these are free and done before the divider."""
        waiting = self.waiting[_DIVIDE]
        if not (self.form.refines and waiting and self.free[_MULTIPLY] <= now < self.free[_DIVIDE]):
            return
        n = waiting[0][1]
        step = self.steps[n]
        if not isinstance(step, Bounded) or (step.endless and self.form.lanes <= _VECTOR):
            return
        cycles = _REFINED[step.endless]
        if now + cycles < self.free[_DIVIDE] + self.costs[n][0]:
            heapq.heappop(waiting)
            busy = _MULTIPLY_ADDS[step.endless] * self.form.lanes / _VECTOR
            self.free[_MULTIPLY] = now + busy
            self._begin(n, now, cycles, replace(step, refined=True))

    def _begin(self, n: int, now: float, cycles: int, step: Step | None = None) -> None:
        self.begun.append(self.steps[n] if step is None else step)
        for k in self.followers[n]:
            self.there[k] = max(self.there[k], now + cycles)
            self.missing[k] -= 1
            if not self.missing[k]:
                heapq.heappush(self.coming, (self.there[k], k))
