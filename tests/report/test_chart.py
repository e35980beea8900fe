"""Scales, ticks and thinned curves, against what they stand for."""

import numpy as np
import pytest

from clepsydra.report.chart import Chart, Scale, path_data, thinned, tick_texts
from clepsydra.report.envelope import envelope


def test_a_path_goes_through_its_points(points_of):
    random = np.random.default_rng(3)
    x = np.cumsum(random.uniform(0.3, 3.0, 200))
    y = random.uniform(-40.0, 40.0, 200)
    assert points_of(path_data(x, y)) == pytest.approx(np.column_stack([x, y]), abs=0.0501)


def test_a_held_path_goes_level_and_then_up(points_of):
    data = path_data(np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 1.0, 4.0, 4.0]), held=True)
    assert points_of(data).tolist() == [[0, 1], [2, 1], [2, 4], [3, 4]]


def test_a_path_is_broken_where_a_value_is_missing():
    data = path_data(np.arange(5.0), np.array([0.0, 1.0, np.nan, 3.0, 4.0]))
    assert data.count("M") == 2
    assert path_data(np.arange(2.0), np.full(2, np.nan)) == ""


def test_thinning_loses_no_peak():
    random = np.random.default_rng(4)
    x = np.linspace(10.0, 450.0, 61_500)
    y = random.normal(size=len(x))
    y[31_234] = 50.0
    thin_x, thin_y = thinned(x, y)
    assert len(thin_x) < 3000
    at = np.searchsorted(x, thin_x - 1e-9)
    assert np.array_equal(y[at], thin_y)
    # Over any three points of the width, the band of what is shown is that of two of them at least.
    for left in range(12, 446, 7):
        inner = y[(x >= left + 0.7) & (x < left + 2.3)]
        shown = thin_y[(thin_x >= left) & (thin_x < left + 3.0)]
        assert shown.max() >= inner.max() and shown.min() <= inner.min(), left
    assert thin_y.max() == 50.0


def test_few_points_stay_as_they_are():
    x = np.linspace(0.0, 100.0, 50)
    assert np.array_equal(envelope(x, x**2, 100)[1], x**2)


def test_points_that_are_not_finite_do_not_hide_others():
    y = np.sin(np.arange(4000.0))
    y[2000:2005] = np.nan
    _, shown = envelope(np.linspace(0.0, 10.0, 4000, endpoint=False), y, 10)
    assert np.nanmax(shown) == np.nanmax(y) and np.nanmin(shown) == np.nanmin(y)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.0, 10.0, ["0", "5", "10"]),
        (-0.31, 0.12, ["−0.2", "0.0"]),
        (11.9, 14.2, ["12", "13", "14"]),
        (1.0e-7, 4.0e-7, ["1e−07", "2e−07", "3e−07", "4e−07"]),
    ],
)
def test_ticks_are_round_and_inside(low, high, expected):
    assert tick_texts(Scale(low, high, 0.0, 1.0).ticks(4)) == expected


@pytest.mark.parametrize(
    ("low", "high"), [(0.95, 2.3), (0.05, 3.0), (1e-6, 1e2), (1e-12, 1e9), (3.0, 700.0)]
)
def test_logarithmic_ticks_are_enough_and_not_too_many(low, high):
    ticks = Scale(low, high, 0.0, 1.0, logarithmic=True).ticks()
    assert 2 <= len(ticks) <= 11
    assert all(0.999 * low <= tick <= 1.001 * high for tick in ticks)


def test_a_scale_that_runs_down_and_one_of_decades():
    assert Scale(2.0, 4.0, 100.0, 20.0).place(3.5) == pytest.approx(40.0)
    assert Scale(0.1, 10.0, 0.0, 60.0, True).place(1.0) == pytest.approx(30.0)


def test_words_and_titles_are_escaped():
    chart = Chart(20.0, "<script>", "a")
    chart.text(0.0, 0.0, "<b>")
    assert "<script" not in chart.svg() and "<b>" not in chart.svg()
