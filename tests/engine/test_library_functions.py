"""Trigonometric, hyperbolic and other functions of a kernel against decimals and C99's tables."""

import math

import numpy as np
import pytest
from printed_functions import computed, same, worst

from clepsydra.engine.elementary_functions import ERROR_BOUND
from clepsydra.engine.trigonometric import LARGEST_ANGLE
from clepsydra.program.operation import LIBRARY

INFINITY, NAN = math.inf, math.nan
RANDOM = np.random.default_rng(31)
COUNT = 300


def between(low, high):
    return RANDOM.uniform(low, high, COUNT)


def sizes(low, high):
    """Return numbers of either sign, as many in each binary order of magnitude."""
    return RANDOM.choice([-1.0, 1.0], COUNT) * 2.0 ** between(low, high)


#: Where the largest errors were found, and from one end to the other.
ARGUMENTS = {
    "asin": [between(-1, 1), between(0.5, 0.56), 1 - 2.0 ** between(-53, -2), sizes(-70, 0)],
    "acos": [between(-1, 1), between(0.5, 0.57), 1 - 2.0 ** between(-53, -2), sizes(-70, 0)],
    "atan": [between(-3, 3), between(0.41, 0.43), sizes(-70, 1023)],
    "sinh": [between(-5, 5), between(0.34, 0.38), sizes(-70, 9.4), between(700, 710.47)],
    "cosh": [between(-5, 5), between(18.3, 18.5), sizes(-70, 9.4), between(700, 710.47)],
    "tanh": [between(-3, 3), between(0.17, 0.18), sizes(-70, 5)],
    "expm1": [between(-5, 5), between(0.34, 0.39), sizes(-70, 5), between(700, 709.78)],
    "log1p": [between(-1, 5), between(0.35, 0.42), sizes(-70, -1), 2.0 ** between(0, 1023)],
    "sin": [between(-10, 10), between(0.75, 0.79), sizes(-70, 39.9)],
    "cos": [between(-10, 10), between(0.75, 0.81), sizes(-70, 39.9)],
    "tan": [between(-10, 10), between(0.76, 0.79), sizes(-70, 39.9)],
    "erf": [between(-6, 6), between(-1, 1), between(1.12, 1.2), sizes(-70, 0)],
    "asinh": [between(-5, 5), between(0.34, 0.36), sizes(-70, 1023)],
    "acosh": [between(1, 5), 1 + 2.0 ** between(-52, -1), 2.0 ** between(0, 1023)],
    "atanh": [between(-1, 1), between(0.16, 0.18), sizes(-70, -0.01), 1 - 2.0 ** between(-53, -1)],
}  # fmt: skip


@pytest.mark.parametrize("name", ARGUMENTS)
def test_a_function_of_one_number_is_within_its_bound(name):
    assert worst(name, np.concatenate(ARGUMENTS[name])) <= ERROR_BOUND[name]


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_an_angle_near_a_multiple_of_a_quarter_turn_loses_nothing(name):
    turns = np.round(2.0 ** between(0, 39.2))
    assert worst(name, turns * (math.pi / 2)) <= ERROR_BOUND[name]
    assert worst(name, turns * (math.pi / 4)) <= ERROR_BOUND[name]


@pytest.mark.parametrize("name", ["atan2", "hypot"])
@pytest.mark.parametrize(
    ("x", "y"),
    [
        pytest.param(between(-1, 1), between(-1, 1), id="around the origin"),
        pytest.param(between(0.38, 0.42), between(-1, 1), id="where the angle is turned"),
        pytest.param(sizes(-1000, 1000), sizes(-1000, 1000), id="everywhere"),
        pytest.param(sizes(1000, 1023.4), sizes(1000, 1023.4), id="large"),
        pytest.param(sizes(-1020, -1000), sizes(-1020, -1000), id="small"),
    ],
)
def test_a_function_of_two_numbers_is_within_its_bound(name, x, y):
    result = computed(name, y, x)
    normal = np.abs(result) > 2.0**-1022
    assert np.count_nonzero(normal) > COUNT // 2
    assert worst(name, y[normal], x[normal]) <= ERROR_BOUND[name]


def test_every_function_is_printed_and_none_errs_by_a_unit_in_the_last_place():
    assert set(ERROR_BOUND) == set(LIBRARY)
    assert max(ERROR_BOUND.values()) < 1.0


EVERYWHERE = np.concatenate([sizes(-1074, 1023), sizes(-30, 6), sizes(-3, 0)])


@pytest.mark.parametrize(
    "name", ["asin", "atan", "sinh", "tanh", "sin", "tan", "erf", "asinh", "atanh"]
)
def test_an_odd_function_is_odd_in_every_bit(name):
    values = computed(name, EVERYWHERE)
    assert np.count_nonzero(np.isfinite(values)) > COUNT
    assert np.array_equal(computed(name, -EVERYWHERE), -values, equal_nan=True)


@pytest.mark.parametrize("name", ["cos", "cosh"])
def test_an_even_function_is_even_in_every_bit(name):
    values = computed(name, EVERYWHERE)
    assert np.array_equal(computed(name, -EVERYWHERE), values, equal_nan=True)


@pytest.mark.parametrize(
    "name", ["asin", "atan", "sinh", "tanh", "sin", "tan", "asinh", "atanh", "expm1", "log1p"]
)
def test_what_is_tiny_is_returned_as_it_is(name):
    tiny = np.array([0.0, -0.0, 5e-324, -5e-324, 2.0**-1022, -1e-310, 1e-300, -1e-30])
    for value, x in zip(computed(name, tiny), tiny, strict=True):
        assert same(value, x)


HALF_TURN, QUARTER_TURN = math.pi, math.pi / 2


@pytest.mark.parametrize(
    ("name", "x", "expected"),
    [
        ("asin", 1.0, QUARTER_TURN), ("asin", 1.0000000000000002, NAN), ("asin", -INFINITY, NAN),
        ("acos", 1.0, 0.0), ("acos", -1.0, HALF_TURN), ("acos", 0.0, QUARTER_TURN),
        ("acos", -0.0, QUARTER_TURN), ("acos", -1.0000000000000002, NAN), ("acos", INFINITY, NAN),
        ("atan", INFINITY, QUARTER_TURN), ("atan", -INFINITY, -QUARTER_TURN),
        ("atan", 1.0, math.pi / 4), ("atan", 1.7976931348623157e308, QUARTER_TURN),
        ("sinh", INFINITY, INFINITY), ("sinh", -INFINITY, -INFINITY), ("sinh", 711.0, INFINITY),
        ("cosh", 0.0, 1.0), ("cosh", -0.0, 1.0), ("cosh", 5e-324, 1.0), ("cosh", 711.0, INFINITY),
        ("cosh", INFINITY, INFINITY), ("cosh", -INFINITY, INFINITY),
        ("tanh", INFINITY, 1.0), ("tanh", -INFINITY, -1.0), ("tanh", 20.0, 1.0),
        ("expm1", INFINITY, INFINITY), ("expm1", -INFINITY, -1.0), ("expm1", -50.0, -1.0),
        ("expm1", 709.79, INFINITY),
        ("log1p", -1.0, -INFINITY), ("log1p", -1.0000000000000002, NAN),
        ("log1p", INFINITY, INFINITY), ("log1p", -INFINITY, NAN),
        ("sin", INFINITY, NAN), ("sin", -INFINITY, NAN), ("cos", 0.0, 1.0), ("cos", -0.0, 1.0),
        ("cos", 5e-324, 1.0), ("cos", INFINITY, NAN), ("tan", -INFINITY, NAN),
        ("erf", 0.0, 0.0), ("erf", -0.0, -0.0), ("erf", INFINITY, 1.0), ("erf", -INFINITY, -1.0),
        ("erf", 6.0, 1.0), ("erf", 1e300, 1.0),
        ("asinh", INFINITY, INFINITY), ("asinh", -INFINITY, -INFINITY),
        ("acosh", 1.0, 0.0), ("acosh", 0.9999999999999999, NAN), ("acosh", INFINITY, INFINITY),
        ("acosh", -INFINITY, NAN), ("acosh", -2.0, NAN),
        ("atanh", 1.0, INFINITY), ("atanh", -1.0, -INFINITY), ("atanh", 1.0000000000000002, NAN),
        ("atanh", INFINITY, NAN),
        *((name, NAN, NAN) for name in sorted(ERROR_BOUND) if LIBRARY[name] == 1),
    ],
)  # fmt: skip
def test_a_function_of_one_number_at_its_ends(name, x, expected):
    assert same(computed(name, [x])[0], expected)


@pytest.mark.parametrize(
    ("y", "x", "expected"),
    [
        (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, -0.0, HALF_TURN), (0.0, -1.0, HALF_TURN),
        (1.0, 0.0, QUARTER_TURN), (1.0, -0.0, QUARTER_TURN), (5e-324, 0.0, QUARTER_TURN),
        (1.0, INFINITY, 0.0), (1.0, -INFINITY, HALF_TURN), (INFINITY, 1.0, QUARTER_TURN),
        (INFINITY, -1.0, QUARTER_TURN), (INFINITY, INFINITY, math.pi / 4),
        (INFINITY, -INFINITY, 3 * math.pi / 4), (NAN, 1.0, NAN), (1.0, NAN, NAN),
        (NAN, INFINITY, NAN), (INFINITY, NAN, NAN), (NAN, 0.0, NAN), (0.0, NAN, NAN),
        (1e300, 1e-300, QUARTER_TURN), (1e-300, 1e300, 0.0), (1e-300, -1e300, HALF_TURN),
    ],
)  # fmt: skip
def test_the_angle_of_a_point_at_its_ends(y, x, expected):
    assert same(computed("atan2", [y], [x])[0], expected)
    assert same(computed("atan2", [-y], [x])[0], -expected)


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        (3.0, -4.0, 5.0), (0.0, -0.0, 0.0), (0.0, -2.5, 2.5), (5e-324, 0.0, 5e-324),
        (3 * 2.0**-1074, 4 * 2.0**-1074, 5 * 2.0**-1074), (3e307, 4e307, 5e307),
        (1.7e308, 1.7e308, INFINITY), (INFINITY, NAN, INFINITY), (NAN, -INFINITY, INFINITY),
        (NAN, 1.0, NAN), (0.0, NAN, NAN), (-INFINITY, 1.0, INFINITY),
    ],
)  # fmt: skip
def test_a_hypotenuse_at_its_ends(x, y, expected):
    assert same(computed("hypot", [x], [y])[0], expected)


def test_angles_that_doubles_hardly_tell_apart_are_not_a_number():
    beyond = [math.nextafter(LARGEST_ANGLE, INFINITY), -1e300]
    for name in ("sin", "cos", "tan"):
        assert np.isnan(computed(name, beyond)).all()
        assert np.isfinite(computed(name, [LARGEST_ANGLE, -LARGEST_ANGLE])).all()


def test_a_remainder_is_exact():
    x, y = sizes(-40, 40), sizes(-12, 40)
    whole = np.round(2.0 ** between(0, 50))
    for a, b in ((x, y), (y * np.round(2.0 ** between(0, 20)), y), (whole, np.round(y) + 0.5)):
        assert np.abs(a / b).max() < 2.0**53
        for value, left, right in zip(computed("fmod", a, b), a, b, strict=True):
            assert same(value, math.fmod(left, right))


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        (6.0, 2.0, 0.0), (-6.0, 2.0, -0.0), (-0.0, 2.0, -0.0), (5.5, -2.0, 1.5),
        (1.0, INFINITY, 1.0), (-1e300, -INFINITY, -1e300), (INFINITY, 2.0, NAN),
        (1.0, 0.0, NAN), (0.0, 0.0, NAN), (NAN, 1.0, NAN), (1.0, NAN, NAN),
        (5e-324, 2.0, 5e-324), (2.0**53 - 1, 1.0, 0.0), (2.0**53, 1.0, NAN), (1e300, 3.0, NAN),
    ],
)  # fmt: skip
def test_a_remainder_at_its_ends(x, y, expected):
    assert same(computed("fmod", [x], [y])[0], expected)


def test_a_sign_is_copied_from_zeros_and_infinities_too():
    size = np.array([0.0, 1.5, INFINITY, -2.0])
    for sign in (0.0, -0.0, 3.0, -INFINITY):
        assert np.array_equal(
            computed("copysign", size, sign).view(np.int64),
            np.copysign(size, sign).view(np.int64),
        )
