"""How the page tells numbers, in Node: as the ranking does."""

import math

import pytest
from page_in_node import source

from clepsydra.report.figures import time_or_never
from clepsydra.report.quantities import number_text

SCRIPT = f"""
import {{ cellText }} from "{source("live/told.ts")}";
answer(given.numbers.map((number) => cellText(given.column, number)));
"""
NUMBERS = [0.0, 1e-6, 0.00123, 0.5, 1.0, 9.996, 12.3456, 179.9, 300.0, 12345.6, 1e6, 3e7, math.inf]


def column(**more):
    return {"kind": "figure", "unit": "", "digits": 2, "time": False, **more}


def told(node, numbers=NUMBERS, **more):
    return node(SCRIPT, {"column": column(**more), "numbers": numbers})


@pytest.mark.parametrize("digits", [2, 3])
def test_a_number_has_the_digits_of_the_ranking(node, digits):
    expected = [number_text(number, digits) for number in NUMBERS]
    assert told(node, kind="multiples", digits=digits) == expected
    assert told(node, digits=digits) == ["–", *expected[1:]]  # a figure of nothing


def test_a_time_has_the_unit_of_the_ranking(node):
    expected = [time_or_never(None, "", number) for number in NUMBERS[1:]]
    assert told(node, NUMBERS[1:], time=True) == expected


def test_what_is_counted_is_whole_and_once_is_a_word(node):
    assert told(node, [math.nan, 0.0, 1.0, 2.0], unit="times", digits=0) == [
        "–", "–", "once", "2 times",
    ]  # fmt: skip
    assert told(node, [-0.2, 12.6, math.inf], unit="%", digits=0) == ["0 %", "13 %", "∞ %"]
