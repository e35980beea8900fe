import math
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from deployed import bits
from hypothesis import given
from hypothesis import strategies as st
from tools import need_grammar

from clepsydra import InputError
from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.printing.decimal_text import decimal
from clepsydra.deploy.printing.expressions import (
    Expression,
    flag,
    variable,
)
from clepsydra.deploy.printing.lines import folded
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.statements import StructuredText

C = C99("law", "double")
TEXT = StructuredText(dialect_of("codesys"), "double")
A, B, D, P, Q = variable("a"), variable("b"), variable("d"), flag("p"), flag("q")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimal_reads_back_every_bit_and_is_a_real_literal(value):
    text = decimal(value)
    assert bits(float(text)) == bits(value)
    mantissa, _, exponent = text.partition("E")
    whole, point, fraction = mantissa.removeprefix("-").partition(".")
    assert whole.isdigit() and point and fraction.isdigit()
    assert not exponent or exponent.removeprefix("-").isdigit()


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_decimal_has_no_text_for_what_is_not_finite(value):
    with pytest.raises(ValueError, match="no decimal form"):
        decimal(value)


def two(code, left, right):
    return Expression(code, (left, right))


@pytest.mark.parametrize(
    ("expression", "in_c", "in_text"),
    [
        (two("add", two("add", A, B), D), "a + b + d", "a + b + d"),
        (two("add", A, two("add", B, D)), "a + (b + d)", "a + (b + d)"),
        (two("subtract", A, two("subtract", B, D)), "a - (b - d)", "a - (b - d)"),
        (two("multiply", two("add", A, B), D), "(a + b) * d", "(a + b) * d"),
        (two("divide", A, two("multiply", B, D)), "a / (b * d)", "a / (b * d)"),
        (two("divide", two("divide", A, B), D), "a / b / d", "a / b / d"),
        (two("subtract", A, Expression("negate", (B,))), "a - (-b)", "a - (-b)"),
        (two("multiply", Expression("constant", number=-2.0), A), "(-2.0) * a", "(-2.0) * a"),
        (Expression("negate", (two("add", A, B),)), "-(a + b)", "-(a + b)"),
        (Expression("not", (two("less", A, B),)), "!(a < b)", "NOT (a < b)"),
        (two("and", Expression("not", (P,)), Q), "!p && q", "NOT p AND q"),
        (two("and", two("and", P, Q), P), "p && q && p", "p AND q AND p"),
        (two("or", two("and", P, Q), P), "(p && q) || p", "(p AND q) OR p"),
        (two("and", P, two("and", Q, P)), "p && (q && p)", "p AND (q AND p)"),
        (two("or", two("equal", A, B), P), "(a == b) || p", "(a = b) OR p"),
        (Expression("square_root", (two("add", A, B),)), "sqrt(a + b)", "SQRT(a + b)"),
        (A.to("boolean"), "a != 0.0", "a <> 0.0"),
    ],
)
def test_parentheses_keep_the_tree(expression, in_c, in_text):
    assert C.render(expression) == in_c
    assert TEXT.render(expression) == in_text


def test_choices_of_c():
    assert C.render(two("maximum", A, B)) == "a > b ? a : b"
    assert C.render(two("minimum", A, B)) == "a < b ? a : b"
    inner = Expression("select", (Q, A, B))
    assert C.render(Expression("select", (P, inner, D))) == "p ? (q ? a : b) : d"
    assert C.render(two("add", P.to("real"), A)) == "(p ? 1.0 : 0.0) + a"


def test_choices_of_structured_text():
    """SEL has the alternative of FALSE first; MAX and MIN of a system may differ for zeros."""
    assert TEXT.render(two("maximum", A, B)) == "FC_Max(a, b)"
    assert TEXT.render(two("minimum", A, B)) == "FC_Min(a, b)"
    assert TEXT.render(Expression("select", (P, A, B))) == "SEL(p, b, a)"
    assert TEXT.render(two("add", P.to("real"), A)) == "SEL(p, 0.0, 1.0) + a"


@pytest.mark.parametrize("code", ["tanh", "hypot"])
def test_structured_text_refuses_what_it_cannot_express(code):
    with pytest.raises(InputError, match=f"operation {code}"):
        TEXT.render(Expression(code, (P, A, B)))


def test_structured_text_refuses_infinity_and_c_writes_it():
    infinite = Expression("constant", number=-math.inf)
    assert C.render(infinite) == "-HUGE_VAL"
    for number in (math.inf, math.nan):
        with pytest.raises(InputError, match=r"got (inf|nan), expected a number that Structured"):
            TEXT.render(Expression("constant", number=number))


VALUES = {"a": 0.1, "b": -7.3, "d": 1e-9}
COMPUTE = {"add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide}
TREES = st.recursive(
    st.sampled_from([A, B, D]) | st.floats(-9, 9).map(lambda x: Expression("constant", number=x)),
    lambda inner: (
        st.builds(two, st.sampled_from(sorted(COMPUTE)), inner, inner)
        | inner.map(lambda operand: Expression("negate", (operand,)))
    ),
    max_leaves=12,
)


def computed(tree: Expression) -> float:
    if tree.code == "variable":
        return VALUES[tree.text]
    if tree.code == "constant":
        return tree.number
    operands = [np.float64(computed(operand)) for operand in tree.operands]
    with np.errstate(all="ignore"):
        return float(-operands[0] if tree.code == "negate" else COMPUTE[tree.code](*operands))


@given(TREES)
def test_the_parsed_text_computes_the_bits_of_the_tree(tree):
    need_grammar()
    from clepsydra.deploy.proof.text.interpreter import function_block

    block = function_block(
        "FUNCTION_BLOCK trees VAR_INPUT a : LREAL; b : LREAL; d : LREAL; END_VAR "
        f"VAR_OUTPUT y : LREAL; END_VAR y := {TEXT.render(tree)}; END_FUNCTION_BLOCK"
    )
    assert bits(block(**VALUES)["y"]) == bits(computed(tree))


@given(st.integers(0, 2**32 - 1), st.integers(1, 9))
def test_a_simplified_condition_is_true_where_it_was_before(seed, size):
    """Over random conditions and all values of their flags; no NOT of a bracketed AND or OR."""
    draw = np.random.default_rng(seed)
    names = "pqr"

    def condition(parts: int) -> tuple[Expression, Callable[[dict[str, bool]], bool]]:
        if parts == 1:
            name = names[draw.integers(3)]
            return flag(name), lambda values: values[name]
        code = ("and", "or", "not")[draw.integers(3)]
        if code == "not":
            inner, meant = condition(parts - 1)
            return Expression("not", (inner,)).simplified(), lambda values: not meant(values)
        cut = int(draw.integers(1, parts))
        (left, first), (right, second) = condition(cut), condition(parts - cut)
        join = all if code == "and" else any
        whole = Expression(code, (left, right)).simplified()
        return whole, lambda values: join([first(values), second(values)])

    found, meant = condition(size)
    text = TEXT.render(found)
    assert "NOT (" not in text and "NOT NOT" not in text
    for values in product([False, True], repeat=3):
        given_flags = dict(zip(names, values, strict=True))
        assert eval(text.lower(), {}, given_flags) == meant(given_flags), text


def test_a_part_of_a_condition_that_is_said_twice_is_written_once():
    for repeated in (
        two("and", P, P),
        two("and", two("and", P, Q), P),
        two("and", P, two("and", P, Q)),
    ):
        text = TEXT.render(repeated.simplified())
        assert text in ("p", "p AND q")
    differ = (
        two("less", A, Expression("constant")),
        two("less", A, Expression("constant", number=-0.0)),
    )
    assert C.render(two("and", *differ).simplified()) == "(a < 0.0) && (a < -0.0)"


LONG = "covariance_of_the_level_of_tank_1_and_of_that_of_tank_2_and_3"


@pytest.mark.parametrize("line", [
    f"filter(a := 1.0, {LONG} := of.{LONG}, b := of.{LONG}, {LONG}_2 := of.{LONG}_2, u := u);",
    f"  y = (cold ? 0.0 : the->{LONG} * state->{LONG}[state->{LONG}_place]) + (warm ? 0.0 : x);",
    f"y := {LONG}_x1;",
])  # fmt: skip
def test_a_line_is_broken_as_often_as_it_can_be_and_no_oftener(line):
    rows = [*folded(line)]
    assert "".join("".join(rows).split()) == "".join(line.split())
    assert all(row.strip() for row in rows)
    # Only what has no place to break it may be longer.
    assert all(len(row) <= 100 or max(map(len, row.split())) > 60 for row in rows)
