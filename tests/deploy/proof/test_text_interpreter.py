"""The interpreter of Structured Text: what it computes, and what it refuses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools import need_grammar

from clepsydra.deploy.proof.text.interpreter import StructuredText, function_block
from clepsydra.deploy.proof.text.tree import StructuredTextError
from clepsydra.deploy.proof.text.values import nearest_single


@pytest.fixture(autouse=True)
def _grammar():
    need_grammar()


def block(body: str, declared: str = ""):
    return function_block(
        "FUNCTION_BLOCK law\n"
        "VAR_INPUT a : LREAL; b : LREAL; p : REAL; q : REAL; n : DINT; c : BOOL; END_VAR\n"
        "VAR_OUTPUT y : LREAL; r : REAL; m : DINT; d : BOOL; END_VAR\n"
        f"{declared}\n{body}\nEND_FUNCTION_BLOCK"
    )


SINGLES = st.floats(width=32, allow_nan=False)


@given(SINGLES, SINGLES)
def test_real_arithmetic_is_rounded_after_every_operation(p, q):
    law = block("r := p * q + p / q - SQRT(ABS(q));")
    with np.errstate(all="ignore"):
        x, y = np.float32(p), np.float32(q)
        expected = np.float32(
            np.float32(np.float32(x * y) + np.float32(x / y)) - np.float32(np.sqrt(abs(y)))
        )
    found = law(p=p, q=q)["r"]
    assert np.float32(found) == found or math.isnan(found)
    found = np.float32(found)
    assert found.tobytes() == expected.tobytes() or (math.isnan(found) and math.isnan(expected))


def test_real_is_not_computed_in_double():
    # In doubles the sum keeps the small number, and so would a rounding at the end only.
    law = block("r := (p + q) - p;")
    assert law(p=2.0**24, q=1.0)["r"] == 0.0
    assert block("y := (a + b) - a;")(a=2.0**24, b=1.0)["y"] == 1.0


@given(st.floats(), st.floats())
def test_quotients_and_roots_of_doubles_follow_ieee_754(a, b):
    law = block("y := SQRT(a) / b;")
    with np.errstate(all="ignore"):
        expected = np.float64(np.sqrt(np.float64(a)) / np.float64(b))
    found = np.float64(law(a=a, b=b)["y"])
    assert found.tobytes() == expected.tobytes() or (math.isnan(found) and math.isnan(expected))


@given(st.integers(0, 2**31 - 1), st.integers(-1, 1))
def test_a_decimal_becomes_the_nearest_single_number(bits, side):
    """Decimals at and beside the middle of two neighbours, where a double rounds twice."""
    from fractions import Fraction

    low = np.uint32(bits).view(np.float32)
    with np.errstate(over="ignore"):
        high = np.nextafter(low, np.float32(math.inf))
    if not np.isfinite(high):
        return
    middle = (Fraction(float(low)) + Fraction(float(high))) / 2 + side * Fraction(1, 10**250)
    digits = middle * 10**260
    text = f"{digits.numerator // digits.denominator}E-260"
    found = nearest_single(text)
    if side == 0:
        assert found in (low, high) and not int(np.float32(found).view(np.int32)) & 1
    else:
        assert found == (low if side < 0 else high)


def test_both_operands_of_and_are_evaluated():
    law = block(
        "d := (n < 3) AND (table[n] > 0.5);",
        "VAR CONSTANT table : ARRAY[0..2] OF LREAL := [1.0, 0.0, 1.0]; END_VAR",
    )
    assert [bool(law(n=n)["d"]) for n in range(3)] == [True, False, True]
    with pytest.raises(StructuredTextError, match=r"index 3 outside 0\.\.2"):
        law(n=3)


def test_integers_stay_within_32_bits_and_divide_towards_zero():
    law = block("m := (n + 1) MOD 5;")
    assert [law(n=n)["m"] for n in (3, 4, -8)] == [4, 0, -2]
    with pytest.raises(StructuredTextError, match="leaves DINT"):
        law(n=2**31 - 1)


@given(st.integers(-50, 50), st.booleans())
def test_integers_are_limited_and_selected(n, c):
    law = block(
        "m := LIMIT(-9, n, 9) - 2 * MAX(n, 3) + MIN(IN1 := n, IN2 := 4);\n"
        "d := SEL(c, n < 0, n > 7);\ny := SEL(G := c, IN0 := a, IN1 := 2.0);\n"
        "r := SEL(c, 0.5, DINT_TO_REAL(BOOL_TO_DINT(c)));"
    )
    found = law(n=n, c=c, a=0.1)
    assert found["m"] == min(max(n, -9), 9) - 2 * max(n, 3) + min(n, 4)
    assert found["d"] == (n > 7 if c else n < 0)
    assert (found["y"], found["r"]) == ((2.0, 1.0) if c else (0.1, 0.5))


def test_what_lives_between_calls_and_what_does_not():
    counting = block(
        "kept := kept + 1; FOR i := 0 TO 2 DO kept := kept + i; END_FOR; m := kept;",
        "VAR RETAIN kept : DINT := 10; END_VAR VAR_TEMP i : DINT; END_VAR",
    )
    assert [counting()["m"], counting()["m"]] == [14, 18]
    forgetting = block("IF c THEN t := 1; END_IF; m := t;", "VAR_TEMP t : DINT; END_VAR")
    assert forgetting(c=True)["m"] == 1
    with pytest.raises(StructuredTextError, match="t is read before it was written"):
        forgetting(c=False)


COUNT = """\
FUNCTION_BLOCK law
VAR_INPUT n : DINT; END_VAR
VAR_OUTPUT m : DINT; END_VAR
VAR_TEMP k : DINT; END_VAR
{}
END_FUNCTION_BLOCK
"""
SUM = "m := 0; FOR k := 1 TO n DO m := m + k; END_FOR;"


def test_a_while_goes_on_as_long_as_its_condition_holds():
    law = function_block(
        COUNT.format("m := 0; k := 1; WHILE k <= n DO m := m + k; k := k + 1; END_WHILE;")
    )
    assert [law(n=n)["m"] for n in (-1, 0, 1, 4)] == [0, 0, 1, 10]


def test_the_only_turn_of_a_for_is_refused_where_not_every_system_takes_it():
    law, strict = (function_block(COUNT.format(SUM), one_turn=each) for each in (True, False))
    assert [law(n=n)["m"] for n in (0, 1, 4)] == [0, 1, 10]
    assert [strict(n=n)["m"] for n in (0, 4)] == [0, 10]
    with pytest.raises(StructuredTextError, match="a FOR from 1 to 1"):
        strict(n=1)


def test_an_index_that_follows_from_counters_stays_inside_its_array():
    """Where it is known to, nothing looks at it later: a place too far on either side is told."""
    declared = "VAR x : ARRAY[0..8] OF LREAL; i, j : DINT; END_VAR"
    through = "FOR i := 0 TO {} DO FOR j := 0 TO i DO x[3 * i + j - {}] := 1.0; END_FOR; END_FOR;"
    for entry, value in ((8, 1.0), (5, 0.0)):
        law = block(through.format(2, 0) + f" y := x[{entry}];", declared)
        assert law()["y"] == value
    for turns, place in (((3, 0), 9), ((2, 1), -1)):
        law = block(through.format(*turns), declared)
        with pytest.raises(StructuredTextError, match=rf"index {place} outside 0\.\.8"):
            law()


def test_a_product_of_counters_that_leaves_dint_is_told():
    law = block("FOR i := 70000 TO 70001 DO m := i * i; END_FOR;", "VAR i : DINT; END_VAR")
    with pytest.raises(StructuredTextError, match="4900000000 leaves DINT"):
        law()


LOOP = """
FUNCTION_BLOCK controller
VAR_INPUT level : LREAL; END_VAR
VAR_OUTPUT flow : LREAL; END_VAR
flow := 0.5 * (2.0 - level);
END_FUNCTION_BLOCK
FUNCTION_BLOCK tank
VAR_INPUT flow : LREAL; END_VAR
VAR_OUTPUT level : LREAL; END_VAR
VAR held : LREAL := 1.0; END_VAR
held := held + flow;
level := held;
END_FUNCTION_BLOCK
PROGRAM tank_test
VAR law : controller; plant : tank; scans : DINT; END_VAR
law(level := plant.level);
plant(flow := law.flow);
scans := scans + 1;
END_PROGRAM
CONFIGURATION whole
RESOURCE processor ON PLC
TASK scan(INTERVAL := T#500ms, PRIORITY := 1);
PROGRAM test WITH scan : tank_test;
END_RESOURCE
END_CONFIGURATION
"""


def test_a_program_calls_its_blocks_scan_by_scan():
    text = StructuredText(LOOP)
    test, other = text.instance("tank_test"), text.instance("tank_test")
    levels = []
    for _ in range(4):
        test.run()
        levels.append(test.state["plant"].state["level"])
    # From 1, or from the 0 of an output before its first call: halfway to 2 in each scan.
    assert levels == [2.0, 2.0, 2.0, 2.0]
    assert test.state["scans"] == 4 and other.state["scans"] == 0
    assert other.state["plant"] is not test.state["plant"]


REFUSED = {
    "y := p;": "y is LREAL, the value REAL",
    "r := p + a;": "REAL + LREAL",
    "r := LREAL#0.5 * p;": "LREAL * REAL",
    "y := 1;": "y is LREAL, the value DINT",
    "m := 1.0;": "m is DINT, the value LREAL",
    "m := n ** 2;": "** of DINT",
    "m := MAX(n, 1.0);": "MAX of DINT, LREAL",
    "y := SEL(c, n, a);": "SEL of BOOL, DINT, LREAL",
    "m := LIMIT(MN := 0, MX := 9, IN := n);": "is no argument 2 of LIMIT",
    "y := z;": "z is not declared",
    "a := 1.0;": "a may not be written",
    "IF a THEN y := 1.0; END_IF;": "a condition is BOOL, the value LREAL",
    "y := NOT a;": "NOT of LREAL",
    "y := MAX(a, b);": "MAX of LREAL, LREAL is unknown",
    "y := SQRT(n);": "SQRT of DINT is unknown",
    "REPEAT y := a; UNTIL c END_REPEAT;": "no meaning for repeat_statement",
    "FOR m := 0 TO 3 BY 2 DO y := a; END_FOR;": "no BY expected",
    "FOR m := 0 TO 3 DO m := 2; END_FOR;": "m may not be written",
    "m := 2147483648;": "2147483648 leaves DINT",
    "r := 1.0E39;": "1.0E39 is too large for REAL",
    "y := a[0];": "a is no array",
    "other(a := 1.0);": "other is not declared",
    "y := a +;": "the grammar does not accept",
}


@pytest.mark.parametrize("body", REFUSED)
def test_a_wrong_text_is_refused_with_its_line(body):
    with pytest.raises(StructuredTextError) as caught:
        block(body)
    assert REFUSED[body] in str(caught.value)
    assert str(caught.value).startswith("line 5") or "DINT" in str(caught.value)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("inner(b := 1.0);", "b is no input of half"),
        ("inner(a := TRUE);", "a is LREAL, the value BOOL"),
        ("inner(1.0);", "inputs are given by name"),
        ("inner(a := 1.0, held => y);", "held is no output of half"),
        ("inner(a => y);", "a is no output of half"),
        ("inner(a := 1.0, y => n);", "n takes no LREAL"),
        ("inner(a := 1.0, y => z);", "z is not declared"),
        ("y := inner.held;", "held is no output of half"),
        ("inner.a := 1.0;", "no meaning for a value of inner.a"),
    ],
)
def test_a_wrong_call_is_refused(call, message):
    text = (
        "FUNCTION_BLOCK half VAR_INPUT a : LREAL; END_VAR VAR_OUTPUT y : LREAL; END_VAR "
        "VAR held : LREAL; END_VAR held := a; y := 0.5 * a; END_FUNCTION_BLOCK\n"
        f"PROGRAM main VAR inner : half; y : LREAL; n : DINT; END_VAR {call} END_PROGRAM"
    )
    with pytest.raises(StructuredTextError, match=message):
        StructuredText(text).instance("main").run()


def test_a_call_hands_over_its_outputs():
    """A value and a structure, as they are behind the call; a structure is copied."""
    text = (
        "TYPE pair : STRUCT low : LREAL; high : LREAL; END_STRUCT; END_TYPE\n"
        "FUNCTION_BLOCK span VAR_INPUT a : LREAL; END_VAR "
        "VAR_OUTPUT ends : pair; wide : LREAL; END_VAR "
        "ends.low := -a; ends.high := a; wide := 2.0 * a; END_FUNCTION_BLOCK\n"
        "PROGRAM main VAR inner : span; kept : pair; low, high, wide : LREAL; END_VAR "
        "inner(a := 3.0, ends => kept, wide => wide); inner(a := 5.0); "
        "low := kept.low; high := kept.high; END_PROGRAM"
    )
    main = StructuredText(text).instance("main")
    main.run()
    assert [main.state[name] for name in ("low", "high", "wide")] == [-3.0, 3.0, 6.0]


def test_the_type_of_a_literal_is_that_of_what_stands_beside_it():
    law = block("d := 0.1 < p; r := EXPT(p, 2.0) * (1.0 - 0.9);")
    assert not law(p=np.float32(0.1))["d"]  # in doubles 0.1 is below the single 0.1
    assert law(p=3.0)["r"] == np.float32(9.0) * (np.float32(1.0) - np.float32(0.9))


LARGER = """FUNCTION larger : LREAL
VAR_INPUT p, q : LREAL; END_VAR
larger := SEL(p > q, q, p);
END_FUNCTION
"""
CALLER = """FUNCTION_BLOCK law
VAR_INPUT a : LREAL; n : DINT; END_VAR
VAR_OUTPUT y : LREAL; END_VAR
y := {call};
END_FUNCTION_BLOCK
"""


def test_a_function_of_the_text_is_called():
    law = function_block(LARGER + CALLER.format(call="larger(0.5, larger(p := a, q := -1.0))"))
    assert [law(a=a)["y"] for a in (0.25, 0.75, -math.inf)] == [0.5, 0.75, 0.5]
    assert (
        math.copysign(1.0, function_block(LARGER + CALLER.format(call="larger(a, -0.0)"))()["y"])
        < 0
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (LARGER + CALLER.format(call="larger(a)"), "no function of 1 inputs"),
        (LARGER + CALLER.format(call="larger(a, n)"), "the value DINT"),
        (LARGER + CALLER.format(call="larger(q := a, p := a)"), "is not p of larger"),
        (CALLER.format(call="larger(a, a)") + LARGER, "unknown here"),
        (
            LARGER.replace(": LREAL\n", ": tank\n", 1) + CALLER.format(call="a"),
            "a function of TANK",
        ),
    ],
)
def test_a_wrong_function_is_refused(text, message):
    with pytest.raises(StructuredTextError, match=message):
        StructuredText(text)


RECORD = "TYPE\n  {name} : STRUCT\n    x : LREAL;{more}\n  END_STRUCT;\nEND_TYPE\n"
BLOCK = "FUNCTION_BLOCK kept\nVAR_INPUT\n  x : LREAL;\nEND_VAR\nEND_FUNCTION_BLOCK\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RECORD.format(name="kept", more="") * 2, "kept is declared twice"),
        (BLOCK + RECORD.format(name="Kept", more=""), "Kept is declared twice"),
        (RECORD.format(name="kept", more="") + BLOCK, "kept is declared twice"),
        (BLOCK * 2, "kept is declared twice"),
        (RECORD.format(name="kept", more=" X : DINT;"), "x is declared twice"),
    ],
)
def test_what_is_declared_twice_is_refused(text, message):
    with pytest.raises(StructuredTextError, match=message):
        StructuredText(text)


def test_two_types_are_read():
    StructuredText(RECORD.format(name="one", more="") + RECORD.format(name="other", more=""))
