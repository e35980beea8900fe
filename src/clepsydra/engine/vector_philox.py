"""Prints Philox 4×32-10 over lanes that have one word of the key each."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.philox import GROWTH, MULTIPLIERS, ROUNDS, WORD

Words = tuple[str, str, str, str]


class PhiloxPrinter:
    """Words of vectors of lanes that share counters and the lower word of their keys.

    Parameters
    ----------
    text : LaneFunction
    lower : str
        Name of the lower word of all keys.
    uppers : sequence of str
        Name of the upper words of each vector of lanes.
    """

    def __init__(self, text: LaneFunction, lower: str, uppers: Sequence[str]) -> None:
        self._text = text
        self._keys: list[tuple[str, list[str]]] = []
        own = list(uppers)
        for _ in range(ROUNDS):
            self._keys.append((lower, own))
            lower = self._alike("and", self._alike("add", lower, GROWTH[0]), WORD)
            own = [self._word(text.on_bits("add", each, GROWTH[1])) for each in own]

    def words(self, units: Sequence[tuple[str, int]], stream: str) -> list[Words]:
        """Append the words of some blocks, each for one of the vectors (block, vector).

        They are printed side by side, since each has to wait for itself from round to round.
        """
        text = self._text
        states = [self._first_round(block, vector, stream) for block, vector in units]
        for left, rights in self._keys[1:]:
            spread = text.spread("i64", left)
            before, states = states, []
            for (first, second, third, fourth), (_, vector) in zip(before, units, strict=True):
                one = text.on_bits("mul", first, MULTIPLIERS[0])
                other = text.on_bits("mul", third, MULTIPLIERS[1])
                first = self._exclusive(text.on_bits("lshr", other, 32), second, spread)
                third = self._exclusive(text.on_bits("lshr", one, 32), fourth, rights[vector])
                states.append((first, self._word(other), third, self._word(one)))
        return states

    def _first_round(self, block: str, vector: int, stream: str) -> Words:
        """Append a round of what is the same in all lanes, but for their words of the key."""
        left, rights = self._keys[0]
        one = self._alike("mul", self._alike("and", block, WORD), MULTIPLIERS[0])
        other = self._alike("mul", stream, MULTIPLIERS[1])
        first = self._alike("xor", self._alike("lshr", other, 32), self._alike("lshr", block, 32))
        first = self._alike("xor", first, left)
        third = self._text.on_bits("xor", self._spread("lshr", one, 32), rights[vector])
        # LLVM multiplies words where it sees that they are words.
        return (
            self._word(self._text.spread("i64", first)),
            self._spread("and", other, WORD),
            self._word(third),
            self._spread("and", one, WORD),
        )

    def _alike(self, operation: str, a: str, b: str | int) -> str:
        """Append a whole operation on what is the same in all lanes."""
        return self._text.assign(f"{operation} i64 {a}, {b}")

    def _spread(self, operation: str, a: str, b: int) -> str:
        return self._text.spread("i64", self._alike(operation, a, b))

    def _word(self, number: str) -> str:
        return self._text.on_bits("and", number, WORD)

    def _exclusive(self, a: str, b: str, c: str) -> str:
        return self._text.on_bits("xor", a, self._text.on_bits("xor", b, c))
