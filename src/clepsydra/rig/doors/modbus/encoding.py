"""How a value stands in registers: as float32, as counts of a card, as a whole number, as a bit."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from clepsydra.rig.tag import Tag

_SIGN, _WORD = 0x8000, 0x10000


@dataclass(frozen=True)
class Card:
    """The codes of an analog card over its nominal range.

    Parameters
    ----------
    low, high : int
        The codes of both ends of the range.
    lowest, highest : int
        The last codes beyond them that are still a value.
    failed : int
        What it shows where there is no value, as with a broken wire.
    signed : bool
        Whether a register holds it as two's complement.
    """

    low: int
    high: int
    lowest: int
    highest: int
    failed: int
    signed: bool

    def code(self, value: float, tag: Tag) -> int:
        """Return the code of a value, in the unit of its tag; beyond the last code, the last."""
        if math.isnan(value):
            return self.failed
        signal = tag.signal
        share = (value - signal.low) / signal.span
        scaled = self.low + share * (self.high - self.low)
        return round(min(max(scaled, self.lowest), self.highest))

    def value(self, code: int, tag: Tag) -> float:
        """Return the value of a code, in the unit of its tag; not-a-number where it is none."""
        if not self.lowest <= code <= self.highest:
            return math.nan
        share = (code - self.low) / (self.high - self.low)
        return tag.signal.low + share * tag.signal.span


class Encoding(Enum):
    """How a value stands in registers, by what a map calls it.

    `FLOAT32` and `UINT32` have their high word in the first register, as Modbus sends the high
    byte of a word first; many devices have it in the second one. `COUNTS_27648` are the counts of
    cards of SIMATIC, with over-range down to −4864 and up to 32511 and 32767 for a broken wire.
    `COUNTS_32767` and `COUNTS_65535` use all codes of 15 and 16 bits, without over-range; the
    first has negative codes free for a broken wire, the second shows its low end then.
    `MICROAMPERES` are the current of a loop of 4 to 20 mA, which by NAMUR NE 43 is a value from
    3.8 to 20.5 mA and tells a failure at 3.6 mA. `UINT16` are whole numbers, and switches in a
    register; `UINT32` are for status words, of which some have more than 16 bits. `BIT` are
    switches in a coil or a discrete input.
    """

    FLOAT32 = "float32"
    FLOAT32_LOW_WORD_FIRST = "float32-low-word-first"
    COUNTS_27648 = "counts-27648"
    COUNTS_32767 = "counts-32767"
    COUNTS_65535 = "counts-65535"
    MICROAMPERES = "microamperes"
    UINT16 = "uint16"
    UINT32 = "uint32"
    UINT32_LOW_WORD_FIRST = "uint32-low-word-first"
    BIT = "bit"

    @property
    def size(self) -> int:
        """How many registers it takes."""
        return 2 if self.is_float or self in _LONG else 1

    @property
    def is_float(self) -> bool:
        """Whether it is a number of single precision."""
        return self in (Encoding.FLOAT32, Encoding.FLOAT32_LOW_WORD_FIRST)

    @property
    def is_of_values(self) -> bool:
        """Whether measured values stand so."""
        return self.is_float or self.card is not None

    @property
    def low_word_first(self) -> bool:
        """Whether the first of two registers is the low one."""
        return self in (Encoding.FLOAT32_LOW_WORD_FIRST, Encoding.UINT32_LOW_WORD_FIRST)

    @property
    def largest(self) -> int:
        """The largest whole number that so many registers hold."""
        return _WORD**self.size - 1

    @property
    def card(self) -> Card | None:
        """The card whose counts it has, if of one."""
        return _CARDS.get(self)

    def encode(self, value: float, tag: Tag) -> tuple[int, ...]:
        """Return the registers of a value, or its bit, as numbers from 0 to 65535.

        Parameters
        ----------
        value : float
            In the unit of the tag's signal.
        tag : Tag
            For its range.

        Examples
        --------
        >>> from clepsydra.base.signal import Signal
        >>> from clepsydra.rig.tag import Writer
        >>> signal = Signal("level", "m", low=0.0, high=10.0)
        >>> level = Tag("level.pv", "LI101", signal, Writer.PLANT, "level", "m")
        >>> [f"{word:04X}" for word in Encoding.FLOAT32.encode(1.5, level)]
        ['3FC0', '0000']
        >>> Encoding.COUNTS_27648.encode(5.0, level), Encoding.MICROAMPERES.encode(5.0, level)
        ((13824,), (12000,))
        """
        if self.card is not None:
            return (self.card.code(value, tag) % _WORD,)
        if self is Encoding.BIT:
            return (int(not (math.isnan(value) or value == 0.0)),)
        if self is Encoding.UINT16:
            return (self._whole(value),)
        form, number = (">f", _single(value)) if self.is_float else (">I", self._whole(value))
        high, low = struct.unpack(">HH", struct.pack(form, number))
        return (low, high) if self.low_word_first else (high, low)

    def _whole(self, value: float) -> int:
        return 0 if math.isnan(value) else round(min(max(value, 0.0), self.largest))

    def decode(self, words: Sequence[int], tag: Tag) -> float:
        """Return what registers, or a bit, say, in the unit of the tag's signal.

        The ends of what a tag takes are met by the codes nearest to them, which may round to
        beyond.

        Returns
        -------
        float
            Not-a-number where the registers hold none.
        """
        if self in (Encoding.UINT16, Encoding.BIT):
            return float(words[0])
        if self.card is not None:
            code = words[0] - _WORD if self.card.signed and words[0] >= _SIGN else words[0]
            found = self.card.value(code, tag)
            return found if math.isnan(found) else min(max(found, tag.lowest), tag.highest)
        high, low = reversed(words) if self.low_word_first else words
        form = ">f" if self.is_float else ">I"
        found = float(struct.unpack(form, struct.pack(">HH", high, low))[0])
        if not self.is_float:
            return found
        if _single(tag.lowest) <= found <= _single(tag.highest):
            return min(max(found, tag.lowest), tag.highest)
        return found


_LONG = (Encoding.UINT32, Encoding.UINT32_LOW_WORD_FIRST)
_CARDS = {
    Encoding.COUNTS_27648: Card(0, 27648, -4864, 32511, failed=32767, signed=True),
    Encoding.COUNTS_32767: Card(0, 32767, 0, 32767, failed=-32768, signed=True),
    Encoding.COUNTS_65535: Card(0, 65535, 0, 65535, failed=0, signed=False),
    Encoding.MICROAMPERES: Card(4000, 20000, 3800, 20500, failed=3600, signed=False),
}


def _single(value: float) -> float:
    """Return the number of single precision next to a number; infinite beyond its range."""
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)
