"""The page and the screen of an identification: what they say is what was found."""

import html
import io
import re
import xml.etree.ElementTree as tree
from dataclasses import replace

import numpy as np
import pandas
import pytest
from matplotlib.colors import to_rgb
from rich.console import Console

import clepsydra as cl
from clepsydra import Signal
from clepsydra.report.identification_page import (
    estimate_cells,
    identification_answer,
    identification_text,
)
from clepsydra.report.identification_picture import (
    ComparedSignal,
    comparison_figure,
    correlations_figure,
)
from clepsydra.report.page import svg_text
from clepsydra.report.screen import Screen

PLANT = cl.load("quadruple-tank")
STEPS = [
    cl.step("pump_1", to=value, at=at)
    for value, at in (
        ("3.5 V", "1 min"),
        ("2.6 V", "6 min"),
        ("3.2 V", "11 min"),
        ("2.9 V", "15 min"),
    )
]


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """The record of a simulation, with noise on all four sensors."""
    path = tmp_path_factory.mktemp("record") / "record.csv"
    cl.simulate(PLANT, None, STEPS, duration="18 min").save(path)
    table = pandas.read_csv(path)
    noise = np.random.default_rng(1)
    for name in (f"level_{k} [V]" for k in (1, 2, 3, 4)):
        table[name] += noise.normal(0.0, 0.02, len(table))
    table.to_csv(path, index=False)
    return path


@pytest.fixture(scope="module")
def models(record):
    return cl.identify(record, "pump_1", "level_1")


@pytest.fixture(scope="module")
def parameters(record):
    return cl.identify(record, plant=PLANT, parameters=["outlet_1.area", "splitter_1.tank_1"])


def words_of(page):
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", page)).split())


@pytest.mark.parametrize("kind", ["models", "parameters"])
def test_the_page_is_whole_and_says_the_verdict(kind, request):
    found = request.getfixturevalue(kind)
    page = identification_text(found)
    assert page == identification_text(found)
    words = words_of(page)
    assert found.verdict in words
    assert page.count("<svg") == 2 and page.rstrip().endswith("</html>")
    assert "http" not in re.sub(r'(xmlns(:xlink)?|http-equiv)="[^"]*"', "", page).replace("doi", "")
    for svg in re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL):
        tree.fromstring(svg)


def test_every_estimate_stands_on_the_page(models, parameters):
    words = words_of(identification_text(models))
    for model in models.models:
        for estimate in model.estimates:
            value, interval, _ = estimate_cells(estimate)
            assert f"{model.name}, {estimate.signal.description}" in words
            assert value in words and interval in words, estimate
    words = words_of(identification_text(parameters))
    for estimate in (*parameters.estimates, *parameters.start):
        assert estimate.signal.name in words and estimate_cells(estimate)[1] in words


@pytest.mark.parametrize("width", [80, 100])
@pytest.mark.parametrize("kind", ["models", "parameters"])
def test_it_answers_in_a_screen(kind, width, request):
    found = request.getfixturevalue(kind)
    console = Console(width=width, record=True, file=io.StringIO())
    console.print(Screen(identification_answer(found)))
    lines = [line.rstrip() for line in console.export_text().splitlines()]
    assert len(lines) <= 24 and max(map(len, lines)) <= width  # one more says what was written
    assert found.verdict in " ".join(" ".join(lines).split())
    assert any(line.startswith("Next:") for line in lines[-2:])


def test_what_gives_no_settings_is_not_told_to_be_entered(models, tmp_path):
    """A level that rises whatever the pump does tells nothing of it."""
    assert "enter the settings" in str(identification_answer(models))
    time = np.arange(0.0, 240.0, 2.0)
    record = tmp_path / "rising.csv"
    pumped = np.where(time < 120.0, 3.0, 4.0)
    pandas.DataFrame(
        {"time [s]": time, "pump [V]": pumped, "level [m]": 0.12 + 5e-6 * time}
    ).to_csv(record, index=False)
    answer = str(identification_answer(cl.identify(record)))
    assert "No control settings follow" in answer and "enter the settings" not in answer
    assert "record more and larger steps of pump" in answer


def test_a_name_from_a_file_is_text():
    signal = Signal("<b>level $x_1$", "m")
    compared = [ComparedSignal(signal, np.arange(9.0), (("x & y", np.zeros(9)),))]
    picture = svg_text(comparison_figure(np.arange(9.0), 6, compared), "a < b", "p")
    tree.fromstring(picture)
    assert "<b>" not in picture


def test_a_model_that_runs_away_does_not_press_the_others_flat():
    time, level = np.arange(60.0), np.sin(np.arange(60.0))
    away = (("a", level), ("b", 1e12 * time), ("c", np.full(60, np.nan)))
    ends = [
        comparison_figure(time, 40, [ComparedSignal(Signal("y"), level, models)]).axes[0].get_ylim()
        for models in (away[:1], away)
    ]
    assert ends[0] == ends[1] == pytest.approx((-1.12, 1.12), abs=0.01)


def test_what_is_held_back_is_shaded():
    compared = [ComparedSignal(Signal("y"), np.arange(60.0), (("a", np.arange(60.0)),))]
    (axes,) = comparison_figure(np.arange(60.0), 40, compared).axes
    (shaded,) = axes.patches
    assert (shaded.get_x(), shaded.get_x() + shaded.get_width()) == (40.0, 59.0)


def test_correlations_are_those_of_the_definition():
    """The bar of lag 3 of a signal that repeats after three samples is the longest."""
    residuals = np.tile([1.0, 0.0, -1.0], 40)
    axes = correlations_figure(residuals, [("pump", residuals)]).axes[0]
    (bars,) = axes.collections
    heights = [float(stop - start) for (_, start), (_, stop) in bars.get_segments()]
    assert max(heights) == heights[2] == pytest.approx(117 / 120)
    assert tuple(bars.get_colors()[2][:3]) == pytest.approx(to_rgb("#D55E00"))
    assert heights[0] == pytest.approx(-39 / 80)


def test_an_interval_that_says_nothing_is_not_printed(models):
    lag = Signal("time_constant", "s", low=0.0)
    estimate = replace(models.best.estimates[0], signal=lag, value=2.0, low=1e-9, high=1e12)
    assert estimate_cells(estimate) == ("2.00", "not told", "s")
