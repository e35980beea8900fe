"""Idioms that CasADi folds: each is found, folds indeed, and what is written instead works."""

import math
import re
from pathlib import Path

import casadi as ca
import pytest

from clepsydra.base.vanishing import vanishing

PAGE = (Path(__file__).parents[2] / "docs" / "own-law.md").read_text(encoding="utf-8")
TABLE = PAGE.partition("### What CasADi simplifies")[2].partition("\n\n(CasADi")[0]
NAMES = {"ca": ca, "sqrt": ca.sqrt}
#: The rules are those of 3.8, and the page says so; versions before have some of them.
FOLDS = tuple(map(int, ca.__version__.split(".")[:2])) >= (3, 8)
#: What vanishes, and what becomes of it.
IDIOMS = {
    "x == x": "1",
    "x != x": "0",
    "x <= x": "1",
    "x < x": "0",
    "(x + y) - y": "x",
    "(x + y) - x": "y",
    "x + y - y": "x",
    "(x - y) + y": "x",
    "y + (x - y)": "x",
    "ca.sqrt(x)**2": "x",
    "sqrt(x) * sqrt(x)": "x",
    "x * (1 / x)": "1",
    "(y / x) * x": "y",
    "x * y / y": "x",
    "x / x": "1",
    "x - x": "0",
    "x * 0": "0",
    "x + 0.0": "x",
    "0 + x": "x",
}


def expression(text):
    """Return what CasADi makes of a text, as a text."""
    return ca.SX(eval(text, NAMES | {"x": ca.SX.sym("x"), "y": ca.SX.sym("y")}))


def value(text, x, y=0.0):
    """Return the value of an expression of two numbers."""
    symbols = ca.SX.sym("x"), ca.SX.sym("y")
    written = ca.SX(eval(text, NAMES | dict(zip("xy", symbols, strict=True))))
    return float(ca.Function("f", symbols, [written])(x, y))


@pytest.mark.parametrize(("text", "becomes"), IDIOMS.items())
def test_an_idiom_that_folds_is_found(text, becomes):
    if FOLDS:
        assert str(expression(text)) == becomes
    (found,) = vanishing(f"import casadi as ca\nasked = {text}\n")
    assert (found.line, found.becomes) == (2, becomes)


@pytest.mark.parametrize(
    "text",
    [
        "ca.logic_not(ca.fabs(x) <= 1e300)",
        "x - (y - x)",
        "(x + y) - 2 * y",
        "x * x / x",
        "ca.sqrt(x * x)",
        "ca.sqrt(x)**3",
        "x + 1.0",
        "x == y",
        "1.0 - 1.0",
        "ca.if_else(x == 0, 0, x)",
        "'x != x'",
    ],
)
def test_what_stays_is_not_found(text):
    assert vanishing(f"asked = {text}") == ()


def test_the_page_has_every_idiom_and_each_is_found():
    first = [cells.split("|")[1] for cells in TABLE.splitlines() if cells.startswith("| `")]
    shown = [text for cell in first for text in re.findall("`([^`]+)`", cell)]
    assert set(shown) <= {"ca.sqrt(x) * ca.sqrt(x)", *IDIOMS} and len(shown) == 11
    assert all(len(vanishing(text)) == 1 for text in shown)


def test_what_the_page_writes_instead_works():
    """For what is no number, a rounded sum, below zero, at zero, and a zero of either sign."""
    written = [
        re.findall("`([^`]+)`", row.split("|")[3]) for row in TABLE.splitlines() if "| `" in row
    ]
    is_none, (rounded, difference), positive, case, unsigned = written
    assert [value(is_none[0], x) for x in (math.nan, math.inf, -math.inf, 2.0)] == [1, 1, 1, 0]
    total = rounded.partition(" = ")[2]
    left = difference.replace("s", f"({total})")
    assert value(left, 1.0, 1e16) == (1.0 + 1e16) - 1e16 == 0.0
    assert value("(x + y) - y", 1.0, 1e16) == 1.0 or not FOLDS
    assert [value(positive[0], x) for x in (-2.0, 3.0)] == [0.0, 3.0]
    assert [value(case[0], x) for x in (0.0, -0.0, 3.0)] == [0.0, 0.0, 1.0]
    assert [math.copysign(1.0, value(unsigned[0], x)) for x in (-0.0, 0.0, -2.0)] == [
        1.0,
        1.0,
        -1.0,
    ]
    assert math.copysign(1.0, value("x + 0.0", -0.0)) == -1.0 or not FOLDS
