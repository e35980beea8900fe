"""How long something takes, in words."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clepsydra.base.words import digits_apart, share_text, time_text, with_article

LENGTH = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}


@given(st.floats(1e-3, 9e5))
def test_a_time_is_what_it_says(time):
    number, unit = time_text(time).split(" ")
    assert math.isclose(float(number) * LENGTH[unit], time, rel_tol=0.0051)
    assert "e" not in number


@pytest.mark.parametrize(
    ("time", "said"),
    [(180.0, "180 s"), (181.0, "3.02 min"), (10800.0, "180 min"), (10801.0, "3 h"),
     (259200.0, "72 h"), (259201.0, "3 d"), (math.inf, "no end")],
)  # fmt: skip
def test_the_unit_of_a_time_changes_at_three_of_the_next(time, said):
    assert time_text(time) == said


@given(st.floats(1.0, 10.0), st.floats(1e-12, 1e-2))
def test_a_value_beyond_a_limit_is_shown_beyond_it(limit, beyond):
    value = limit * (1.0 + beyond)
    digits = digits_apart(value, limit)
    assert float(f"{value:.{digits}g}") > float(f"{limit:.{digits}g}")
    assert digits == 4 or f"{value:.{digits - 1}g}" == f"{limit:.{digits - 1}g}"


@given(st.floats(1e-9, 1.0))
def test_a_share_is_told_in_plain_digits(share):
    number, unit = share_text(share).split(" ")
    assert math.isclose(float(number), 100.0 * share, rel_tol=0.051)
    assert unit == "%" and "e" not in number


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("setpoint error", "a setpoint error"),
        ("load error", "a load error"),
        ("outflow change", "an outflow change"),
        ("IAE of level_1", "an IAE of level_1"),
        ("rise time", "a rise time"),
    ],
)
def test_the_article_fits_the_sound(words, said):
    assert with_article(words) == said
