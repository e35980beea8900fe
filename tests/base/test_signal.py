"""A signal's range."""

import math

import pytest

from clepsydra import Signal


def test_span_is_the_width_of_the_range() -> None:
    assert Signal("level_1", "V", low=-2.5, high=10.0).span == 12.5


@pytest.mark.parametrize(
    "limits", [{}, {"low": 0.0}, {"high": 1.0}, {"low": -math.inf, "high": 0.0}]
)
def test_span_is_infinite_where_a_limit_is_open(limits: dict[str, float]) -> None:
    assert Signal("area", "m^2", **limits).span == math.inf


def test_percent_and_back() -> None:
    signal = Signal("pump_1", "V", low=-5.0, high=15.0)
    assert [signal.to_percent(value) for value in (-5.0, 0.0, 15.0)] == [0.0, 25.0, 100.0]
    assert [signal.from_percent(share) for share in (0.0, 25.0, 100.0)] == [-5.0, 0.0, 15.0]
