"""Prints the delay rings of a program: where their values stand and how they advance."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.vector_text import VectorText
from clepsydra.program.delay_ring import DelayRing


class RingPrinter:
    """The rings of a program, one after the other in the memory of a group of lanes.

    The position of ring n is carried from sample to sample as ``%ringn``; `advance` names the
    next position ``%ringn.next``.

    Parameters
    ----------
    text : VectorText
    rings : sequence of DelayRing
        Those of the state, then those of loops.
    """

    def __init__(self, text: VectorText, rings: Sequence[DelayRing]) -> None:
        self._text = text
        self._lengths = [ring.length for ring in rings]
        self._number = {ring.name: number for number, ring in enumerate(rings)}

    @property
    def counters(self) -> list[str]:
        """The names of the positions."""
        return [f"ring{number}" for number in range(len(self._lengths))]

    def number(self, ring: DelayRing) -> int:
        """Return which of the rings one is."""
        return self._number[ring.name]

    def place(self, number: int, position: str) -> str:
        """Return where a ring stands at a position; there its oldest value is."""
        text = self._text
        row = text.assign(f"mul i64 %group, {sum(self._lengths)}")
        row = text.assign(f"add i64 {row}, {sum(self._lengths[:number])}")
        row = text.assign(f"add i64 {row}, {position}")
        return text.row("%rings", row, 1)

    def advance(self, number: int, position: str) -> None:
        """Name the position after this one."""
        text, ring = self._text, f"%ring{number}"
        text.line(f"{ring}.up = add i64 {position}, 1")
        text.line(f"{ring}.end = icmp eq i64 {ring}.up, {self._lengths[number]}")
        text.line(f"{ring}.next = select i1 {ring}.end, i64 0, i64 {ring}.up")
