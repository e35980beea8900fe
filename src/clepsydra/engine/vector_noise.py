"""Prints how a kernel adds noise to its inputs: made for a chunk of samples, read for each."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.noise_code import CHUNK
from clepsydra.engine.vector_text import VectorText

#: What a kernel with noise is given beside what every kernel is: pointers, and a whole number.
NOISE_POINTERS, NOISE_COUNT = ("noise", "plan", "numbers", "made"), "begun"


class NoiseReader:
    """The noise of some inputs, in the loop over samples.

    Parameters
    ----------
    text : VectorText
    inputs : sequence of int
        The values to which noise is added, in the order of the plan.
    """

    def __init__(self, text: VectorText, inputs: Sequence[int]) -> None:
        self._text = text
        self._columns = {value: column for column, value in enumerate(inputs)}

    def __contains__(self, value: int) -> bool:
        return value in self._columns

    def make(self) -> None:
        """Print how a chunk is made where a sample is the first of one, or of the call."""
        text = self._text
        text.line("%noise.at = add i64 %begun, %sample")
        text.line(f"%noise.row = and i64 %noise.at, {CHUNK - 1}")
        text.line("%noise.none = icmp eq i64 %noise.row, 0")
        text.line("%noise.first = icmp eq i64 %sample, 0")
        text.line("%noise.now = or i1 %noise.none, %noise.first")
        # What is live is kept in memory on the way that is seldom taken.
        text.globals.append(f'!1 = !{{!"branch_weights", i32 1, i32 {CHUNK}}}')
        text.line("br i1 %noise.now, label %noise.make, label %noise.made, !prof !1")
        text.begin("noise.make")
        text.line("%noise.left = sub i64 %samples, %sample")
        text.line(f"%noise.room = sub i64 {CHUNK}, %noise.row")
        text.line("%noise.ends = icmp slt i64 %noise.left, %noise.room")
        text.line("%noise.count = select i1 %noise.ends, i64 %noise.left, i64 %noise.room")
        numbers = text.row("%numbers", "%group", 1)
        text.line(
            f"call void %noise(ptr %made, ptr %plan, ptr {numbers}, i64 {len(self._columns)}, "
            "i64 %noise.at, i64 %noise.count)"
        )
        text.line("br label %noise.made")
        text.begin("noise.made")

    def added(self, value: int, quiet: str) -> str:
        """Append what an input is: `quiet`, with noise if it has any."""
        if value not in self:
            return quiet
        text = self._text
        column = f"{self._columns[value] * CHUNK * text.lanes}"
        base = text.assign(f"getelementptr double, ptr %made, i64 {column}")
        noise = text.load(text.row(base, "%noise.row", 1))
        return text.assign(f"fadd {text.real} {quiet}, {noise}")
