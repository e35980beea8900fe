"""Membership functions and rules, against formulas and by hand."""

import casadi as ca
import numpy as np
import pytest

from clepsydra import InputError
from clepsydra.controllers.fuzzy.membership import (
    Gaussian,
    Trapezoid,
    left_shoulder,
    right_shoulder,
    triangle,
)
from clepsydra.controllers.fuzzy.rule import firing, joined, parse_rule

X = np.array([-9.0, -1.0, -0.75, -0.5, -0.25, 0.0, 0.5, 1.0, 1.5, 2.0, 9.0])
SHAPES = {
    "triangle": (triangle(-1, 0, 2), np.interp(X, [-1, 0, 2], [0, 1, 0])),
    "trapezoid": (Trapezoid(-1, -0.5, 1, 2), np.interp(X, [-1, -0.5, 1, 2], [0, 1, 1, 0])),
    "left_shoulder": (left_shoulder(-0.5, 1.5), np.interp(X, [-0.5, 1.5], [1, 0])),
    "right_shoulder": (right_shoulder(-0.5, 1.5), np.interp(X, [-0.5, 1.5], [0, 1])),
    "upright left": (triangle(0, 0, 2), np.where((X >= 0) & (X <= 2), 1 - X / 2, 0)),
    "upright right": (triangle(-1, 1, 1), np.where((X >= -1) & (X <= 1), (X + 1) / 2, 0)),
    "box": (Trapezoid(-0.5, -0.5, 1, 1), ((X >= -0.5) & (X <= 1)).astype(float)),
    "gaussian": (Gaussian(0.5, 0.25), np.exp(-((X - 0.5) ** 2) / 0.125)),
}


def evaluated(shape, places):
    x = ca.SX.sym("x")
    return np.array(ca.Function("f", [x], [shape.expression(x)])(places[None, :])).ravel()


@pytest.mark.parametrize("name", SHAPES)
def test_degrees_are_those_of_the_formula(name):
    shape, expected = SHAPES[name]
    np.testing.assert_allclose(shape.degrees(X), expected, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(evaluated(shape, X), expected, rtol=1e-12, atol=1e-16)


def test_the_expression_of_a_gaussian_is_exact_to_twelve_digits_and_nowhere_zero():
    x = np.concatenate([np.linspace(-8, 8, 1001), [-1e9, -40.0, 40.0, 1e200]])
    found = evaluated(Gaussian(0.0, 1.0), x)
    near = np.abs(x) <= 8
    np.testing.assert_allclose(found[near], np.exp(-(x[near] ** 2) / 2), rtol=1e-12)
    assert np.all(found > 0) and np.all(found <= 1) and np.all(found[~near] < 1e-300)
    assert evaluated(Gaussian(0.3, 0.1), np.array([0.3])) == 1.0


def test_no_degree_is_above_one_whatever_the_width():
    """That is what lets a set which is 1 in a stretch of points be left out of the smallest."""
    random = np.random.default_rng(1)
    for foot, up, down in random.uniform(0.001, 3.0, (300, 3)):
        shape = triangle(-foot, up, up + down)
        near = up + np.array([-1e-16, 0.0, 1e-16, -1e-9, 1e-9])
        assert max(shape.degrees(near).max(), evaluated(shape, near).max()) <= 1.0


@pytest.mark.parametrize(
    "make",
    [
        lambda: triangle(0, -1, 1),
        lambda: triangle(1, 1, 1),
        lambda: Trapezoid(0, 2, 1, 3),
        lambda: left_shoulder(1, 0),
        lambda: triangle(0, float("nan"), 1),
        lambda: triangle(0, 1, float("inf")),
        lambda: Gaussian(0, 0),
        lambda: Gaussian(float("nan"), 1),
    ],
)
def test_a_set_out_of_order_is_refused(make):
    with pytest.raises(InputError, match="fuzzy set: got"):
        make()


DEGREES = {("a", "X"): 0.2, ("b", "Y"): 0.7, ("c", "Z"): 0.5, ("d", "W"): 0.9}


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("a is X", 0.2),
        ("a is X and b is Y", 0.2),
        ("a is X or b is Y", 0.7),
        ("a is X or b is Y and c is Z", 0.5),  # AND binds closer
        ("(a is X or b is Y) and c is Z", 0.5),
        ("(a is X or b is Y) and d is W", 0.7),
        ("a is X and (b is Y or c is Z)", 0.2),
        ("a is X and b is Y or c is Z and d is W", 0.5),
        ("((d is W))", 0.9),
    ],
)
def test_and_is_the_smallest_and_or_the_largest(words, expected):
    rule = parse_rule("R", f"IF {words} THEN u is P")
    assert firing(rule.condition, DEGREES, min, max) == expected
    again = parse_rule("R", str(rule))
    assert firing(again.condition, DEGREES, min, max) == expected
    everything = np.random.default_rng(2).random((50, 4))
    for row in everything:
        degrees = dict(zip(DEGREES, row, strict=True))
        assert firing(again.condition, degrees, min, max) == firing(
            rule.condition, degrees, min, max
        )


@pytest.mark.parametrize(
    ("text", "value", "expected"),
    [
        ("", "the end", "if"),
        ("e is N then u is P", "e", "if"),
        ("if e N then u is P", "N after if e", "is"),
        ("if e is N u is P", "u after e is N", "then"),
        ("if e is N then", "the end after is N then", "the name of a variable"),
        ("if e is then u is P", "then after if e is", "the name of a set"),
        ("if e is N and then u is P", "then after is N and", "the name of a variable"),
        ("if (e is N then u is P", "then after e is N", ")"),
        ("if e is N) then u is P", ") after e is N", "then"),
        ("if e is not N then u is P", "N after e is not", "then"),
        ("if e is N then u is P or v is P", "or after u is P", "the end of the rule, or and"),
        ("if e is N then u is P and u is N", "u twice", "each output once in a rule"),
        ("if e = N then u is P", "= after if e", "is"),
        ("if é is N then u is P", "é after if", "the name of a variable"),
    ],
)
def test_a_rule_that_is_none_is_refused(text, value, expected):
    with pytest.raises(InputError) as found:
        parse_rule("R7", text)
    assert (found.value.place, found.value.value) == ("rules.R7", value)
    assert found.value.expected == expected


def test_joined_rules_hold_as_far_as_the_one_of_them_that_holds_most():
    """Random rules and degrees, many of them alike: for each conclusion the largest firing."""
    random = np.random.default_rng(29)
    sets = [(variable, name) for variable in "edf" for name in "NZP"]
    fewer = 0
    for _ in range(300):
        rules = []
        for k in range(random.integers(1, 9)):
            chosen = [" is ".join(sets[j]) for j in random.integers(0, 9, random.integers(1, 5))]
            words = chosen[0]
            for each in chosen[1:]:
                words = f"({words}) {random.choice(['and', 'or'])} {each}"
            concluded = random.choice(["u is N", "u is P", "v is N", "u is N and v is P"])
            rules.append(parse_rule(f"R{k}", f"if {words} then {concluded}"))
        found = joined(rules)
        told = [rule.conclusions for rule in found]
        assert len({*told}) == len(told) and {*told} == {rule.conclusions for rule in rules}
        # What is joined can be read as a rule.
        found = tuple(parse_rule(rule.name, str(rule)) for rule in found)
        fewer += len(found) < len(rules)
        degrees = dict(zip(sets, random.choice([0.0, 0.25, 0.5, 0.7, 1.0], 9), strict=True))
        for rule in found:
            alike = [each for each in rules if each.conclusions == rule.conclusions]
            largest = max(firing(each.condition, degrees, min, max) for each in alike)
            assert firing(rule.condition, degrees, min, max) == largest, rules
    assert fewer > 100


def test_a_rule_alone_with_its_conclusion_stays_as_it_is():
    rules = tuple(parse_rule(n, f"if e is {n} or d is {n} then u is {n}") for n in "NZP")
    assert joined(rules) == rules
