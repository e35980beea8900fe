"""Prints what stands around the body of a counted loop."""

from __future__ import annotations

from collections.abc import Iterator

from clepsydra.engine.vector_rings import RingPrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.program.program import ForLoop


class TurnPrinter:
    """The branches and the counter of a loop, its tables and the positions of its rings.

    To make one prints the branch into the loop and the counter; then come values carried in
    registers, if any, `begin`, `rows` and `places`, the body, and `end`.

    Parameters
    ----------
    text : VectorText
    loop : ForLoop
    rings : RingPrinter
        Those of the program, among them those of the loop.

    Attributes
    ----------
    label : str
        Of the first basic block of a turn; the last one is ``label.end``.
    before : str
        The label of the basic block before the loop.
    """

    def __init__(self, text: VectorText, loop: ForLoop, rings: RingPrinter) -> None:
        self.label, self.before = text.new_label("loop"), text.label
        self._text = text
        self._loop = loop
        self._rings = rings
        self._numbers = [rings.number(ring) for ring in loop.rings]
        label = self.label
        text.line(f"br label %{label}")
        text.begin(label)
        text.line(f"%{label}.i = phi i64 [ 0, %{self.before} ], [ %{label}.next, %{label}.end ]")

    def begin(self) -> None:
        """Print the positions of the rings in this turn."""
        for ring in (f"%ring{number}" for number in self._numbers):
            self._text.line(
                f"{ring}.turn = phi i64 [ {ring}, %{self.before} ], "
                f"[ {ring}.next, %{self.label}.end ]"
            )

    def rows(self) -> Iterator[str]:
        """Define each table, and yield the name of its entry of this turn as that is printed."""
        for number, table in enumerate(self._loop.tables):
            symbol = f"@{self.label}.table{number}"
            self._text.table(symbol, table)
            yield self._text.load_spread(symbol, f"%{self.label}.i")

    def places(self) -> list[str]:
        """Return where each ring stands in this turn."""
        return [self._rings.place(number, f"%ring{number}.turn") for number in self._numbers]

    def end(self) -> None:
        """Print the end of a turn and the branch back or behind the loop."""
        text, label = self._text, self.label
        text.line(f"br label %{label}.end")
        text.begin(f"{label}.end")
        for number in self._numbers:
            self._rings.advance(number, f"%ring{number}.turn")
        text.line(f"%{label}.next = add i64 %{label}.i, 1")
        turns = "%turns" if self._loop.adjustable else self._loop.count
        text.line(f"%{label}.more = icmp slt i64 %{label}.next, {turns}")
        text.line(f"br i1 %{label}.more, label %{label}, label %{label}.done")
        text.begin(f"{label}.done")
