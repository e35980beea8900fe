"""What is shown as 0, and what is not, at both sides of each border."""

import math

import numpy as np
import pytest

from clepsydra import Signal
from clepsydra.process.reader import load_process
from clepsydra.report.quantities import quantity_text, settled_gains
from clepsydra.report.score_tables import score_text
from clepsydra.scores.score import SCORES

PUMP = Signal("pump", "V", low=0.0, high=10.0)


@pytest.fixture(scope="module")
def process():
    """Its levels and pumps have ranges of 10 V."""
    return load_process("quadruple-tank")


@pytest.mark.parametrize(
    ("score", "value", "shown"),
    [
        ("overshoot", 1.04e-12, "0"),
        ("overshoot", 0.9e-4, "0"),
        ("overshoot", 1.1e-4, "1.10e−4"),
        ("offset", 0.9e-5, "0"),
        ("offset", -1.1e-5, "−1.10e−5"),
        ("iae", 0.9e-5, "0"),  # 10 V for 1000 s is 1e4 V s
        ("iae", 1.1e-5, "1.10e−5"),
        ("itae", 0.9e-2, "0"),
        ("itae", 1.1e-2, "0.0110"),
        ("ise", 0.9e-13, "0"),
        ("ise", 1.1e-13, "1.10e−13"),
        ("reversals", 1e-30, "1.00e−30"),  # not judged: what is counted has no dust
        ("offset", math.inf, "∞"),
        ("offset", math.nan, "–"),
    ],
)
def test_a_score_is_zero_only_below_what_says_something(process, score, value, shown):
    assert score_text(process, "level_1", value, SCORES[score], 1000.0)[0] == shown


def test_a_signal_without_a_range_keeps_its_digits(process):
    open_ended = Signal("flow", "m^3/s")
    assert quantity_text(open_ended, 1e-20) == "1.00e−20 m³/s"
    assert quantity_text(PUMP, 1e-20) == "0 V"
    assert quantity_text(PUMP, 2e-8) == "2.00e−8 V"


def test_gains_are_compared_in_shares_of_the_ranges():
    """1e-9 V/Pa is much beside 3 V/m where the one has a range of 10 GPa."""
    level = Signal("level", "m", low=0.0, high=1.0)
    pressure = Signal("pressure", "Pa", low=0.0, high=1e10)
    gains = np.array([[3.0, 1e-9], [1e-13, 1e-20]])
    np.testing.assert_array_equal(
        settled_gains(gains, [PUMP, PUMP], [level, pressure]), [[3.0, 1e-9], [0.0, 0.0]]
    )


def test_integrals_of_long_runs_are_in_hours(process):
    for duration, unit, length in ((10800.0, "s", 1.0), (10801.0, "h", 3600.0)):
        for score, power, words in (("iae", 1, f"V {unit}"), ("itse", 2, f"V² {unit}²")):
            shown, in_unit = score_text(process, "level_1", 7.2e7, SCORES[score], duration)
            assert in_unit == words, duration
            assert float(shown) == pytest.approx(7.2e7 / length**power, rel=0.005)
