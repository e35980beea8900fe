"""What stands in registers: codes of the documents of cards, IEEE 754, and there and back."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clepsydra.base.signal import Signal
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.tag import Tag, Writer

LEVEL = Tag(
    "level.pv", "LI101", Signal("level", "m", low=-2.0, high=8.0), Writer.OPERATOR, "level", "m"
)
CARDS = [encoding for encoding in Encoding if encoding.card]
FLOATS = [Encoding.FLOAT32, Encoding.FLOAT32_LOW_WORD_FIRST]

#: Value as a share of the range, and the word in hexadecimal. The first four of 27648 are of
#: SIMATIC S7-1500 Analog value processing, table of unipolar input ranges (over-range to 32511,
#: under-range to −4864, 7FFF for an open wire); those of the loop follow from NAMUR NE 43.
CODES = [
    (Encoding.COUNTS_27648, 0.0, "0000"),
    (Encoding.COUNTS_27648, 1.0, "6C00"),
    (Encoding.COUNTS_27648, 0.75, "5100"),
    (Encoding.COUNTS_27648, 1.17589, "7EFF"),
    (Encoding.COUNTS_27648, 2.0, "7EFF"),
    (Encoding.COUNTS_27648, -1.0, "ED00"),
    (Encoding.COUNTS_27648, math.nan, "7FFF"),
    (Encoding.COUNTS_32767, 1.0, "7FFF"),
    (Encoding.COUNTS_32767, 1.1, "7FFF"),
    (Encoding.COUNTS_32767, -0.1, "0000"),
    (Encoding.COUNTS_32767, math.nan, "8000"),
    (Encoding.COUNTS_65535, 0.0, "0000"),
    (Encoding.COUNTS_65535, 1.0, "FFFF"),
    (Encoding.COUNTS_65535, 0.2, "3333"),
    (Encoding.MICROAMPERES, 0.0, "0FA0"),  # 4 mA
    (Encoding.MICROAMPERES, 0.5, "2EE0"),  # 12 mA
    (Encoding.MICROAMPERES, 1.0, "4E20"),  # 20 mA
    (Encoding.MICROAMPERES, 1.1, "5014"),  # 20.5 mA
    (Encoding.MICROAMPERES, -0.1, "0ED8"),  # 3.8 mA
    (Encoding.MICROAMPERES, math.nan, "0E10"),  # 3.6 mA
]


@pytest.mark.parametrize(("encoding", "share", "word"), CODES)
def test_codes_of_cards(encoding, share, word) -> None:
    value = LEVEL.signal.low + share * LEVEL.signal.span
    assert [f"{each:04X}" for each in encoding.encode(value, LEVEL)] == [word]


@pytest.mark.parametrize(
    ("value", "words"),
    [(1.0, "3F80 0000"), (-118.625, "C2ED 4000"), (0.1, "3DCC CCCD"), (1e39, "7F80 0000")],
)
def test_floats_are_those_of_ieee_754(value, words) -> None:
    high, low = words.split()
    found = [f"{word:04X}" for word in Encoding.FLOAT32.encode(value, LEVEL)]
    other = [f"{word:04X}" for word in Encoding.FLOAT32_LOW_WORD_FIRST.encode(value, LEVEL)]
    assert (found, other) == ([high, low], [low, high])


@pytest.mark.parametrize("encoding", CARDS)
@given(value=st.floats(-2.0, 8.0))
def test_a_value_comes_back_within_half_a_count(encoding, value) -> None:
    card = encoding.card
    half = 0.5 * LEVEL.signal.span / (card.high - card.low)
    found = encoding.decode(encoding.encode(value, LEVEL), LEVEL)
    # Half a count, and what two roundings of numbers up to 8 add.
    assert abs(found - value) <= half + 4e-15


@pytest.mark.parametrize("encoding", CARDS)
@given(word=st.integers(0, 65535))
def test_a_word_is_a_value_that_is_taken_or_none(encoding, word) -> None:
    card, found = encoding.card, encoding.decode([word], LEVEL)
    code = word - 65536 if card.signed and word >= 32768 else word
    if card.lowest <= code <= card.highest:
        assert LEVEL.lowest <= found <= LEVEL.highest
        # All codes but the one below what is taken come back.
        again = encoding.encode(found, LEVEL)[0]
        assert again == word or (encoding is Encoding.COUNTS_27648 and code == -4864)
    else:
        assert math.isnan(found)


@pytest.mark.parametrize("encoding", FLOATS)
@given(value=st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_floats_come_back(encoding, value) -> None:
    found = encoding.decode(encoding.encode(value, LEVEL), LEVEL)
    assert found == value


@pytest.mark.parametrize("encoding", FLOATS)
@given(low=st.floats(-1e6, 1e6), span=st.floats(1e-3, 1e6))
def test_the_ends_of_a_range_are_taken_though_they_round_beyond(encoding, low, span) -> None:
    signal = replace(LEVEL.signal, low=low, high=low + span)
    tag = replace(LEVEL, signal=signal)
    for end in (tag.lowest, tag.highest):
        assert tag.lowest <= encoding.decode(encoding.encode(end, tag), tag) <= tag.highest


@given(value=st.integers(0, 65535), long=st.integers(0, 2**32 - 1))
def test_whole_numbers_come_back(value, long) -> None:
    assert Encoding.UINT16.encode(float(value), LEVEL) == (value,)
    assert Encoding.UINT16.decode((value,), LEVEL) == value
    words = (long >> 16, long & 0xFFFF)
    assert Encoding.UINT32.encode(float(long), LEVEL) == words
    assert Encoding.UINT32_LOW_WORD_FIRST.encode(float(long), LEVEL) == words[::-1]
    assert Encoding.UINT32.decode(words, LEVEL) == long
    assert Encoding.UINT32_LOW_WORD_FIRST.decode(words[::-1], LEVEL) == long
