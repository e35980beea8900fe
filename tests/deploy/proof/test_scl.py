"""SCL as the standard writes it: what is converted, and what is refused instead."""

import pytest
from spoilt_programs import level_control
from tools import need_grammar

from clepsydra.deploy.proof.text.interpreter import function_block
from clepsydra.deploy.proof.text.scl import standard_text
from clepsydra.deploy.proof.text.tree import StructuredTextError
from clepsydra.deploy.structured_text.printer import print_structured_text

TEXT = """FUNCTION_BLOCK "half"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR_INPUT
  u : LREAL := 1.0E-5; // input of "half", see #u
END_VAR
VAR_OUTPUT
  y : LREAL;
  level : LREAL;
END_VAR
VAR
  inner : "other"; // an instance
  table : ARRAY[0..1] OF LREAL := [1.0, 2.0];
END_VAR
VAR_TEMP
  i : DINT;
END_VAR
BEGIN
FOR #i := 0 TO 1 DO
  #y := LREAL#0.5E-1 * #table[#i] + ABS(#u);
END_FOR;
#inner(
  u := #u,
  level := (#y + #level)
);
#level := #inner.level;
END_FUNCTION_BLOCK

FUNCTION_BLOCK "next"
VAR_OUTPUT
  level : LREAL;
END_VAR
BEGIN
#level := LREAL#1.0;
END_FUNCTION_BLOCK
"""


def test_what_the_standard_does_not_know_goes_and_lines_stay():
    found = standard_text(TEXT).splitlines()
    assert len(found) == len(TEXT.splitlines())
    assert found[0] == "FUNCTION_BLOCK half" and [line.strip() for line in found[1:3]] == ["", ""]
    assert found[4] == '  u : LREAL := 1.0E-5; // input of "half", see #u'
    assert found[11] == "  inner : other; // an instance"
    assert found[17:20] == ["", "FOR i := 0 TO 1 DO", "  y := LREAL#0.5E-1 * table[i] + ABS(u);"]
    assert found[21:26] == ["inner(", "  u := u,", "  level := (y + level)", ");",
                            "level := inner.level;"]  # fmt: skip


REFUSED = {
    "a variable without its mark": ("#table[#i]", "table[#i]", "line 20: no mark before table"),
    "an assigned variable without it": ("  #y :=", "  y :=", "line 20: no mark before y"),
    "an argument without it": ("u := #u", "u := u", "line 23: no mark before u"),
    "an instance without it": ("#inner(", "inner(", "line 22: no mark before inner"),
    "an instance's output without it": ("#inner.level", "inner.level", "line 26: no mark before"),
    "a mark before a function": ("ABS(", "#ABS(", "line 20: a mark before ABS"),
    "a mark before a word": ("TO 1", "#TO 1", "line 19: a mark before TO"),
    "a mark before another's input": ("u := #u", "#u := #u", "line 23: a mark before u"),
    "a mark before another's output": ("#inner.level", "#inner.#level", "line 26: a mark before"),
    "a mark before what is not declared": ("#y + #level", "#z + #level", "a mark before z"),
    "a mark before another block's variable": ("#level := LREAL#1.0", "#u := LREAL#1.0",
                                               "line 34: a mark before u"),
    "a mark in a declaration": ("  y : LREAL", "  #y : LREAL", "line 8: a mark in a declaration"),
    "a mark before nothing": ("#y + ", "# y + ", "line 24: no meaning for #"),
    "no BEGIN": ("BEGIN\nFOR", "\nFOR", "line 19: FOR where BEGIN has to stand"),
    "no BEGIN in the second block": ("BEGIN\n#level", "\n#level", "line 34: #level where BEGIN"),
    "two of them": ("BEGIN\nFOR", "BEGIN BEGIN\nFOR", "line 18: a second BEGIN"),
    "BEGIN behind a statement": ("BEGIN\nFOR", "#y := #u; BEGIN\nFOR", "line 18: #y where BEGIN"),
    "a block without quotes": ('"half"\n', "half\n", "line 1: the name half of a block"),
    "a second block without quotes": ('"next"\n', "next\n", "line 29: the name next of a block"),
    "an instance's block without quotes": ('"other"', "other", "line 12: other is no type"),
    "a quoted variable": ("#level := #inner", '"level" := #inner', "line 26: no meaning for"),
    "a block without end": ("LREAL#1.0;\nEND_FUNCTION_BLOCK", "LREAL#1.0;",
                            "the text ends within a block"),
    "a statement outside": ("END_FUNCTION_BLOCK\n\n", "END_FUNCTION_BLOCK\nBEGIN\n",
                            "line 28: BEGIN outside of a block"),
    "a version that is none": ("VERSION : 0.1", "VERSION 0.1", "line 3: a version is a number"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", REFUSED)
def test_a_text_that_the_system_would_not_take_is_refused(mistake):
    right, wrong, message = REFUSED[mistake]
    assert TEXT.count(right) == 1 or right in ("u := #u", "BEGIN\nFOR")
    with pytest.raises(StructuredTextError) as caught:
        standard_text(TEXT.replace(right, wrong, 1))
    assert message in str(caught.value)


def test_each_mark_of_a_printed_text_is_needed():
    """Without any single one of them a printed controller is refused."""
    need_grammar()
    text = print_structured_text(level_control(), dialect="scl")
    assert function_block(standard_text(text)).name == level_control().name
    begin = text.index("BEGIN")
    places = [
        place for place in range(begin, len(text))
        if text[place] == "#" and not text[place - 1].isalnum()
        and "//" not in text[text.rfind("\n", 0, place) : place]
    ]  # fmt: skip
    assert len(places) > 100
    for place in places[::7]:
        with pytest.raises(StructuredTextError, match="no mark before"):
            standard_text(text[:place] + text[place + 1 :])
