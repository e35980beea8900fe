"""Prints a sample twice: its likely path, and all of it for where a test of that fails."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.engine.likely_path import LARGEST
from clepsydra.engine.refined_root import SMALLEST
from clepsydra.engine.steps import Required, Step
from clepsydra.engine.vector_text import VectorText

#: After a sample that was none of the likely path the next take all statements at once: this many
#: the first time, and twice as many each time that the path is not taken then, up to the most. A
#: law that stays below its bound does not pay for the path that it never takes.
_FIRST, _LONGEST = 16, 1024
_WAIT, _NEXT = "unlikely", "unlikely.again"
#: Names in the loop over samples, with what they are at first.
COUNTERS = {_WAIT: 0, _NEXT: _FIRST}


def print_twice(
    text: VectorText,
    values: dict[int, str],
    steps: Sequence[Step],
    every: Callable[[], None],
    printed: Callable[[Step], None],
    results: Sequence[int],
) -> None:
    """Print the path, its tests, and the whole sample, and give `values` the results of either.

    `values`: number to name, as the sample begins; `every` prints all statements, `printed` one of
    them; `results`: values that are no argument.
    """
    text.line(f"%{_WAIT}.here = icmp sgt i64 %{_WAIT}, 0")
    before, begun = dict(values), text.label
    # What is likely stands in a row; weights are no promise.
    text.globals.append('!0 = !{!"branch_weights", i32 1, i32 1000}')
    text.line(f"br i1 %{_WAIT}.here, label %general, label %likely, !prof !0")
    text.begin("likely")
    fails = _path(text, values, steps, printed)
    likely, left = [values[each] for each in results], text.label
    text.line(f"br i1 {fails}, label %general, label %joined, !prof !0")
    text.begin("general")
    _wait(text, begun, left)
    values.clear()
    values.update(before)
    every()
    general, there = [values[each] for each in results], text.label
    text.line("br label %joined")
    text.begin("joined")
    for name, first in (_WAIT, 0), (_NEXT, _FIRST):
        text.line(f"%{name}.next = phi i64 [ {first}, %{left} ], [ %{name}.then, %{there} ]")
    for each, one, other in zip(results, likely, general, strict=True):
        values[each] = text.assign(f"phi {text.real} [ {one}, %{left} ], [ {other}, %{there} ]")


def _wait(text: VectorText, begun: str, left: str) -> None:
    """Print what is waited for after a sample that the path, which ends at `left`, did not give."""
    text.line(f"%{_WAIT}.now = phi i1 [ false, %{begun} ], [ true, %{left} ]")
    text.line(f"%{_WAIT}.fewer = sub i64 %{_WAIT}, 1")
    text.line(f"%{_NEXT}.twice = shl i64 %{_NEXT}, 1")
    text.line(f"%{_NEXT}.longest = icmp sge i64 %{_NEXT}, {_LONGEST}")
    text.line(f"%{_NEXT}.more = select i1 %{_NEXT}.longest, i64 {_LONGEST}, i64 %{_NEXT}.twice")
    for name, now, other in (_WAIT, _NEXT, f"{_WAIT}.fewer"), (_NEXT, f"{_NEXT}.more", _NEXT):
        text.line(f"%{name}.then = select i1 %{_WAIT}.now, i64 %{now}, i64 %{other}")


def _path(
    text: VectorText,
    values: dict[int, str],
    steps: Sequence[Step],
    printed: Callable[[Step], None],
) -> str:
    """Print the path; return whether a test fails in any lane."""
    tests = _Tests(text)
    for step in steps:
        if isinstance(step, Required):
            one, other = (values[each] for each in step.condition.arguments)
            if step.condition.code == "not_equal":
                tests.stays(one, other)
            elif step.usual:
                tests.is_number(one)
            else:
                tests.exceeds(one, other)
        else:
            printed(step)
    return text.in_any_lane(tests.fail())


class _Tests:
    """All tests of a path by few comparisons, which keep units that multiply from their work.

    The sum of all magnitudes, and of all that has a bound, exceeds the largest of them where every
    bound is above zero, and is not a number where one of them is not; so no minimum is asked of it.
    """

    def __init__(self, text: VectorText) -> None:
        self.text = text
        self.total: str | None = None
        self.least: dict[str, str] = {}
        #: Where a test fails in all samples, so that it is computed once, and in this one.
        self.always: list[str] = []
        self.here: list[str] = []

    def is_number(self, magnitude: str) -> None:
        """Ask of a magnitude that it is a number."""
        text, total = self.text, self.total
        added = f"fadd {text.real} {total}, {magnitude}"
        self.total = magnitude if total is None else text.assign(added)

    def exceeds(self, value: str, bound: str) -> None:
        """Ask of a value that it is a number above a bound."""
        text, least = self.text, self.least.get(bound)
        self.is_number(value)
        self.least[bound] = (
            value if least is None else text.choose(text.compare("olt", value, least), value, least)
        )

    def stays(self, setting: str, last: str) -> None:
        """Ask of a setting that it is a number, and in every bit what it was."""
        text = self.text
        self.always.append(text.compare("uno", setting, setting))
        whole = text.real.replace("double", "i64")
        bits = [text.assign(f"bitcast {text.real} {each} to {whole}") for each in (setting, last)]
        self.here.append(text.assign(f"icmp ne {whole} {bits[0]}, {bits[1]}"))

    def fail(self) -> str:
        """Return where one of them fails."""
        text = self.text
        if self.total is not None:
            self.here.append(text.compare("ugt", self.total, text.literal(LARGEST)))
        for bound, least in self.least.items():
            self.always.append(text.compare("uge", text.literal(SMALLEST), bound))
            self.here.append(text.compare("uge", bound, least))
        fails, *others = [*self.always, *self.here]
        for other in others:
            fails = text.assign(f"or {text.truth} {fails}, {other}")
        return fails
