"""Prints a sample twice: its likely path, and all of it for where a test of that fails."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clepsydra.engine.likely_path import Known, Required, Same, Step
from clepsydra.engine.vector_text import VectorText
from clepsydra.program.program import Statement

#: After a sample that was none of the likely path so many take all statements at once: a law that
#: stays below its bound does not pay for the path that it never takes.
_PATIENCE = 16
#: The counter of them: a name in the loop over samples.
WAITS = "unlikely"


def print_twice(
    text: VectorText,
    values: dict[int, str],
    steps: Sequence[Step],
    every: Callable[[], None],
    printed: Callable[[Statement], None],
    results: Sequence[int],
) -> None:
    """Print the path, its tests, and the whole sample, and give `values` the results of either.

    `values`: number to name, as the sample begins; `every` prints all statements, `printed` one of
    them; `results`: values that are no argument.
    """
    text.line(f"%{WAITS}.here = icmp sgt i64 %{WAITS}, 0")
    text.line(f"%{WAITS}.fewer = sub i64 %{WAITS}, 1")
    before, begun = dict(values), text.label
    # What is likely stands in a row; weights are no promise.
    text.globals.append('!0 = !{!"branch_weights", i32 1, i32 1000}')
    text.line(f"br i1 %{WAITS}.here, label %general, label %likely, !prof !0")
    text.begin("likely")
    fails = _path(text, values, steps, printed)
    likely, left = [values[each] for each in results], text.label
    text.line(f"br i1 {fails}, label %general, label %joined, !prof !0")
    text.begin("general")
    text.line(f"%{WAITS}.then = phi i64 [ %{WAITS}.fewer, %{begun} ], [ {_PATIENCE}, %{left} ]")
    values.clear()
    values.update(before)
    every()
    general, there = [values[each] for each in results], text.label
    text.line("br label %joined")
    text.begin("joined")
    text.line(f"%{WAITS}.next = phi i64 [ 0, %{left} ], [ %{WAITS}.then, %{there} ]")
    for each, one, other in zip(results, likely, general, strict=True):
        values[each] = text.assign(f"phi {text.real} [ {one}, %{left} ], [ {other}, %{there} ]")


def _path(
    text: VectorText,
    values: dict[int, str],
    steps: Sequence[Step],
    printed: Callable[[Statement], None],
) -> str:
    """Print the path; return whether a test fails in any lane."""
    fails: list[str] = []
    for step in steps:
        if isinstance(step, Required):
            a, b = (values[each] for each in step.condition.arguments)
            # The opposite of b < a, or of a <= b, holds for not-a-number too.
            fails.append(text.compare("ugt", a, b) if step.usual else text.compare("uge", b, a))
        elif isinstance(step, Known):
            values[step.target] = text.in_every_lane("i1", "true" if step.truth else "false")
        elif isinstance(step, Same):
            values[step.target] = values[step.source]
        else:
            printed(step)
    while len(fails) > 1:
        pairs = zip(fails[::2], fails[1::2], strict=False)
        together = [text.assign(f"or {text.truth} {one}, {other}") for one, other in pairs]
        fails = together + fails[len(together) * 2 :]
    return text.in_any_lane(fails[0])
