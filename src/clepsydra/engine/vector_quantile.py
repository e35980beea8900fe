"""Prints normal deviates of random bits over lanes, by the table of `normal_quantile`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.normal_quantile import SHIFT, SIGNIFICANT, SMALLEST, quantile_table

_SIGN = 1 << 63
#: A double of 2⁵², whose last binary digit counts ones: its bits, and what takes a half less.
_ONES, _OFFSET = 0x4330000000000000, 2.0**52 - 0.5
#: Of a share, the bits that are below those of its piece.
_WITHIN = (1 << SHIFT) - 1
#: Coefficients of a piece, which are a line of the cache, and the bytes of that as a power of 2.
_COEFFICIENTS, _LINE = 8, 6
#: The line of the smallest share, which is 1/2, and the bits of its number that count.
_FIRST = (0x3FE << 52) >> SHIFT
_COUNTED = ((_SIGN - 1) >> (SHIFT - _LINE)) & -(1 << _LINE)


@cache
def _lines() -> tuple[float, ...]:
    """Return the coefficients of each piece by rising powers, one piece after the other."""
    _, *rising = quantile_table()
    powers = (SMALLEST + 1) * np.arange(len(rising))
    return tuple(np.ldexp(np.array(rising).T, powers).ravel().tolist())


class QuantilePrinter:
    """Normal deviates in two steps, by way of memory, from which lines of the table are looked up.

    Shares are 2⁵³ times those of `normal_deviates`, and coefficients less accordingly, which
    rounds nothing; a share has the sign of its deviate.

    Parameters
    ----------
    text : LaneFunction
        Of vectors as the processor has them.
    """

    def __init__(self, text: LaneFunction) -> None:
        self._text = text
        self._lines = text.assign(f"getelementptr i8, ptr @lines, i64 {-(_FIRST << _LINE)}")

    @staticmethod
    def table() -> str:
        """Return the definition of the table that the functions of a module read."""
        text = LaneFunction(1)
        text.table("@lines", _lines(), alignment=1 << _LINE)
        return "\n".join(text.globals)

    @staticmethod
    def share(text: LaneFunction, upper: str, lower: str) -> str:
        """Append the share of two random words."""
        pair = text.on_bits("or", text.on_bits("shl", upper, 32), lower)
        number = text.on_bits("and", text.on_bits("lshr", pair, 11), SIGNIFICANT)
        ones = text.real_of(text.on_bits("or", number, _ONES))
        share = text.bits_of(text.subtract(ones, text.literal(_OFFSET)))
        return text.real_of(text.on_bits("or", share, text.on_bits("and", pair, _SIGN)))

    def deviates(self, places: Sequence[str]) -> list[str]:
        """Append the deviates of the vectors of shares that stand in some places.

        They are printed side by side, since each sum has to wait for the one before.
        """
        text = self._text
        shares = [text.bits_of(text.load(place)) for place in places]
        distances = [self._distance(share) for share in shares]
        *lower, found = zip(*map(self._coefficients, places), strict=True)
        for coefficients in reversed(lower):
            products = [text.multiply(*each) for each in zip(found, distances, strict=True)]
            found = tuple(text.add(*each) for each in zip(products, coefficients, strict=True))
        return [
            text.real_of(text.on_bits("xor", text.bits_of(each), text.on_bits("and", share, _SIGN)))
            for each, share in zip(found, shares, strict=True)
        ]

    def _distance(self, share: str) -> str:
        """Append how far a share lies from the centre of its piece, which is half of one on."""
        text = self._text
        size = text.on_bits("and", share, _SIGN - 1)
        centre = text.on_bits("or", text.on_bits("and", size, ~_WITHIN), (_WITHIN + 1) >> 1)
        return text.subtract(text.real_of(size), text.real_of(centre))

    def _coefficients(self, place: str) -> list[str]:
        """Append the coefficients of the pieces of shares, by rising powers.

        Each lane reads a line, and lines become columns, in less than half of the time of a gather.
        """
        width = self._text.lanes
        lines = [self._line(place, lane) for lane in range(width)]
        if width == 1:
            return [self._load("double", lines[0], index) for index in range(_COEFFICIENTS)]
        found: list[str] = []
        read_at_once = max(width // 2, 2)
        for low in range(0, _COEFFICIENTS, read_at_once):
            kind = f"<{read_at_once} x double>"
            read = [self._load(kind, line, low) for line in lines]
            for even, odd in zip(*map(self._rows, (read[::2], read[1::2])), strict=True):
                for lane in (0, 1):
                    pairs = range(lane, width, 2)
                    found.append(
                        self._shuffle(even, odd, width, [k + i for k in pairs for i in (0, width)])
                    )
        return found

    def _rows(self, read: list[str]) -> list[str]:
        """Append for each pair of coefficients those of all lines, side by side."""
        width = self._text.lanes
        if width == 2:
            return read
        together = range(width)
        halves = [
            self._shuffle(one, other, width // 2, list(together))
            for one, other in zip(read[::2], read[1::2], strict=True)
        ]
        if width == 4:
            return halves
        return [
            self._shuffle(
                halves[0], halves[1], 8, [k + i for k in range(start, 16, 4) for i in (0, 1)]
            )
            for start in (0, 2)
        ]

    def _shuffle(self, a: str, b: str, width: int, mask: list[int]) -> str:
        kind, places = f"<{width} x double>", ", ".join(f"i32 {place}" for place in mask)
        return self._text.assign(
            f"shufflevector {kind} {a}, {kind} {b}, <{len(mask)} x i32> <{places}>"
        )

    def _line(self, place: str, lane: int) -> str:
        """Append where the line of the piece of a share stands."""
        text = self._text
        piece = text.assign(f"lshr i64 {self._load('i64', place, lane)}, {SHIFT - _LINE}")
        offset = text.assign(f"and i64 {piece}, {_COUNTED}")
        return text.assign(f"getelementptr i8, ptr {self._lines}, i64 {offset}")

    def _load(self, kind: str, base: str, index: int) -> str:
        place = self._text.assign(f"getelementptr double, ptr {base}, i64 {index}")
        return self._text.assign(f"load {kind}, ptr {place}, align 8")
