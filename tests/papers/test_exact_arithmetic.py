"""Exact expressions: identities hold, what nearly is one does not, and numbers agree."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clepsydra.papers.exact_matrix import determinant, diagonal, identity, inverse, matrix
from clepsydra.papers.formula import read_formula
from clepsydra.papers.rational_function import RationalFunction, exact, square_root, symbols

x, y = symbols("x y")
#: Too small for any floating point beside one.
TINY = Fraction(1, 10**40)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("(x + y)**3", "x**3 + 3*x**2*y + 3*x*y**2 + y**3"),
        ("(x**2 - y**2)/(x - y)", "x + y"),
        ("1/(1 + 1/x)", "x/(x + 1)"),
        ("x/(x + y) + y/(x + y)", "1"),
        ("x/y/(y/x)", "x**2*y**-2"),
        ("1/(x - y) - 1/(x + y)", "2*y/(x**2 - y**2)"),
        ("sqrt(8)", "2*sqrt(2)"),
        ("sqrt(6)", "sqrt(2)*sqrt(3)"),
        ("sqrt(1/2)", "sqrt(2)/2"),
        ("sqrt(2*x*y**3)**2", "2*x*y**3"),
        ("x**(3/2)/sqrt(x)", "x"),
        ("(sqrt(x) - sqrt(y))*(sqrt(x) + sqrt(y))", "x - y"),
        ("1/(sqrt(2) - 1)", "sqrt(2) + 1"),
        ("(x - sqrt(-1)*y)*(x + sqrt(-1)*y)", "x**2 + y**2"),
        ("328.6*x", "3286*x/10"),
        ("f(x + y)", "f(y + 2*x - x)"),
    ],
)
def test_what_is_one_for_all_values_is_equal(left, right):
    one, two = read_formula(left), read_formula(right)
    assert one == two
    assert one != two + TINY
    assert one * (1 + TINY) != two


@pytest.mark.parametrize(
    ("left", "right"),
    [("x", "y"), ("f(x)", "f(y)"), ("sqrt(2)", "1.4142135623730951"), ("x**2", "x**3"), ("1", "0")],
)
def test_what_is_not_is_not(left, right):
    assert read_formula(left) != read_formula(right)


_NUMBERS = st.fractions(-3, 3, max_denominator=4)


def _sums(of):
    two = st.tuples(of, of)
    return st.one_of(
        two.map(lambda pair: pair[0] + pair[1]),
        two.map(lambda pair: pair[0] - pair[1]),
        two.map(lambda pair: pair[0] * pair[1]),
        two.map(lambda pair: pair[0] / (pair[1] * pair[1] + 1)),
    )


_EXPRESSIONS = st.recursive(
    st.one_of(st.sampled_from([x, y]), _NUMBERS.map(exact)), _sums, max_leaves=6
)


@given(_EXPRESSIONS, _EXPRESSIONS, _NUMBERS, _NUMBERS)
def test_numbers_in_the_place_of_symbols_are_calculated_with_alike(one, two, first, second):
    values = {"x": first, "y": second}

    def at(expression):
        (value,) = expression.with_values(values).numerator.terms.values() or [Fraction(0)]
        return value

    assert at(one + two) == at(one) + at(two)
    assert at(one * two) == at(one) * at(two)
    assert at(one - two) == at(one) - at(two)
    if at(two):
        assert at(one / two) == at(one) / at(two)


@given(_EXPRESSIONS)
def test_what_is_written_is_read_as_it_was(expression):
    assert read_formula(str(expression)) == expression


@given(_EXPRESSIONS, _EXPRESSIONS)
def test_derivatives_follow_the_rules_of_sum_product_and_quotient(one, two):
    first, second = one.derivative("x"), two.derivative("x")
    assert (one + two).derivative("x") == first + second
    assert (one * two).derivative("x") == first * two + one * second
    below = two * two + 1
    quotient = (first * below - one * below.derivative("x")) / (below * below)
    assert (one / below).derivative("x") == quotient


@pytest.mark.parametrize(
    ("text", "slope"),
    [("x**5", "5*x**4"), ("sqrt(x)", "1/(2*sqrt(x))"), ("y", "0"), ("1/x", "-1/x**2")],
)
def test_derivatives_of_powers(text, slope):
    assert read_formula(text).derivative("x") == read_formula(slope)


def test_an_expression_that_is_linear_has_one_root():
    assert (2 * x - y).root("x") == y / 2
    with pytest.raises(AssertionError, match="not linear"):
        (x * x - y).root("x")


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        (1 - x, "1 - x"),
        (x - 1, "x - 1"),
        (-x / y, "-x/y"),
        (x / (2 * y), "x/(2*y)"),
        (x * (1 - y) / (1 + x) ** 2, "x*(1 - y)/(x**2 + 2*x + 1)"),
        (x * (1 - y) / (1 + x) / (1 + x), "x*(1 - y)/(x + 1)**2"),
        (x * (1 + y + 1 / y), "x*(y + 1 + 1/y)"),
        ((1 - x) / y, "(1 - x)/y"),
        (-x * (1 + y) / (1 + x), "-x*(y + 1)/(x + 1)"),
        (square_root(2 * x) ** 3, "2*sqrt(2)*x**(3/2)"),
        (exact(0), "0"),
        (exact(Fraction(-2, 3)), "-2/3"),
    ],
)
def test_a_formula_is_written_as_a_reader_would(expression, text):
    assert str(expression) == repr(expression) == text


def test_only_what_divides_is_divided_out():
    assert ((x**2 - y**2) / (x + y)).factors == {}
    assert len(((x**2 + y**2) / (x + y)).factors) == 1
    assert len((1 / (1 + square_root(2) * x)).factors) == 1


@pytest.mark.parametrize("wrong", [0.5, "x", None])
def test_numbers_that_are_not_exact_are_refused(wrong):
    with pytest.raises(TypeError):
        x + wrong
    assert (x == wrong) is False


def test_nothing_is_divided_by_zero():
    with pytest.raises(ZeroDivisionError):
        1 / (x - x)
    with pytest.raises(ZeroDivisionError):
        (1 / x).with_values({"x": 0})


@pytest.mark.parametrize("text", ["x < y", "x[0]", "'x'", "x if y else 1", "lambda: x", "x.y"])
def test_what_is_no_formula_is_refused(text):
    with pytest.raises(ValueError, match="no part of a formula"):
        read_formula(text)


def test_names_may_stand_for_other_expressions_and_for_matrices():
    M = matrix([[x, 1], [0, y]])
    assert read_formula("2*a", {"a": x + y}) == 2 * x + 2 * y
    assert read_formula("det(a)", {"a": M}) == x * y
    assert np.all(read_formula("a*a**-1", {"a": M}) == identity(2))
    assert np.all(read_formula("a.T - 2*a", {"a": M}) == M.T - 2 * M)


@given(st.lists(st.integers(-9, 9), min_size=9, max_size=9))
def test_determinant_and_inverse_are_those_of_numbers(entries):
    numbers = np.array(entries).reshape(3, 3)
    found = matrix(numbers)
    value = float(determinant(found))
    assert value == pytest.approx(np.linalg.det(numbers), abs=1e-9)
    if value:
        assert np.all(inverse(found) @ found == identity(3))
    else:
        with pytest.raises(StopIteration):
            inverse(found)


def test_the_inverse_of_symbols_is_one_in_both_orders():
    M = matrix([[0, x, 1], [y, 0, x], [1, x + y, 0]])
    assert np.all(inverse(M) @ M == identity(3)) and np.all(M @ inverse(M) == identity(3))
    assert determinant(inverse(M)) * determinant(M) == 1
    assert np.all(inverse(diagonal([x, y])) == diagonal([1 / x, 1 / y]))
    assert isinstance(M[0, 0], RationalFunction)
