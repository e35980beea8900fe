"""The trend picture of a report, against the trajectories that it shows."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from clepsydra.report.colours import signal_colours
from clepsydra.report.panels import all_panels, controlled_panels
from clepsydra.report.trend_svg import trend_svg


@pytest.fixture(scope="module")
def text(run):
    return trend_svg(run, all_panels(run), "all", "a")


def curves(text, colour, width, points_of):
    found = re.findall(rf'<path d="([^"]*)"[^>]*stroke="{colour}" stroke-width="{width}"', text)
    return [points_of(data) for data in found]


def axis_of(text, panel):
    """Numbers at the left of a panel with their places: value → y."""
    ticks = re.findall(r'<text x="40.5" y="([\d.]+)" text-anchor="end">([−\d.]+)<', text)
    places = [(float(y) - 2.7, float(words.replace("−", "-"))) for y, words in ticks]
    groups = [[places[0]]]
    for before, here in pairwise(places):
        if here[0] > before[0]:
            groups.append([])
        groups[-1].append(here)
    return groups[panel]


def test_a_level_stands_where_its_axis_says(text, run, points_of):
    (curve, *_) = curves(text, signal_colours(run.process)["tank_1.level"], "14", points_of)
    (y1, v1), *_, (y2, v2) = axis_of(text, 0)
    levels = v1 + (curve[:, 1] - y1) * (v2 - v1) / (y2 - y1)
    shown = 100 * run.values["tank_1.level"]
    pixel = abs(0.12 * (v2 - v1) / (y2 - y1))
    assert levels.max() == pytest.approx(shown.max(), abs=pixel)
    assert levels.min() == pytest.approx(shown.min(), abs=pixel)
    assert levels[0] == pytest.approx(shown[0], abs=pixel)
    assert levels[-1] == pytest.approx(shown[-1], abs=pixel)


def test_the_strip_limits_saturation_and_units_are_there(text, run):
    for words in ("+1 V = +2 cm", "load", "noise", "rim 20 cm ↑", "time [min]", ">%<"):
        assert words in text
    volts = run.values["pump_1"]
    assert f"at a limit for {np.sum((volts == 0.0) | (volts == 10.0))} s" in text
    assert text.count("url(#a-hatch)") >= 4


def test_the_words_of_a_strip_have_room(text):
    boxes = re.findall(r'<rect x="([\d.]+)" y="1.0" width="([\d.]+)"', text)
    assert len(boxes) == 7
    for words in re.findall(r'font-size="6.5">([^<]*)<', text):
        assert len(words) * 0.58 * 6.5 <= max(float(width) for _, width in boxes)


def test_a_run_that_broke_down_is_still_drawn(run, points_of):
    broken = run.values["tank_1.level"].copy()
    broken[100:] = np.nan
    text = trend_svg(
        replace(run, values=run.values | {"tank_1.level": broken}), controlled_panels(run), "b", "b"
    )
    assert "nan" not in text
    (curve, *_) = curves(text, signal_colours(run.process)["tank_1.level"], "14", points_of)
    assert curve[-1, 0] < 80.0


def test_a_long_run_makes_no_larger_picture(run):
    times = 20
    values = {name: np.tile(column, times) for name, column in run.values.items()}
    long = replace(
        run,
        time=np.arange(len(run.time) * times) * 1.0,
        values=values,
        scenario=replace(run.scenario, noise=np.tile(run.scenario.noise, (times, 1)), segments=()),
    )
    assert len(trend_svg(long, all_panels(run), "a", "a")) < 400_000
