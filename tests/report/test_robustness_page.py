"""The page of many plants: its pictures are whole, named, and show what was found."""

import html
import re
import xml.etree.ElementTree as tree
from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.report.causes_picture import causes_figure
from clepsydra.report.distribution_picture import distribution_figure
from clepsydra.report.fan_picture import fan_figure, fan_windows
from clepsydra.report.page import svg_text
from clepsydra.report.plant_axes import settle
from clepsydra.report.replay_picture import replay_figure
from clepsydra.report.robustness_page import robustness_text
from clepsydra.report.robustness_tables import differences_table
from clepsydra.studies.robustness.distribution import Distribution
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.fan import CHANCES, fan_of
from clepsydra.studies.robustness.sensitivity import Sensitivity, SobolIndex

STILL = {"default": "0 %"}


def found_of(name, **how):
    plant = cl.load(name)
    return cl.robustness(cl.design.simc(plant), plant, **how)


@pytest.fixture(scope="module")
def found():
    return found_of("quadruple-tank", draws=100)


@pytest.fixture(scope="module")
def page(found):
    return robustness_text(found)


def svgs(page):
    return re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)


def words_of(page):
    return " ".join(
        html.unescape(re.sub(r"<(style|svg).*?</\1>|<[^>]*>", " ", page, flags=re.S)).split()
    )


def check(svg):
    """No place in a picture is no number, and it is well-formed."""
    tree.fromstring(svg)
    for attribute in re.findall(r' (?:d|x|y|width|height|points|transform)="[^"]*"', svg):
        assert not re.search(r"\b(nan|inf)\b", attribute, re.IGNORECASE), attribute


def test_the_page_is_whole(found, page):
    assert page == robustness_text(found) and page.rstrip().endswith("</html>")
    assert "http" not in re.sub(r'(xmlns(:xlink)?|http-equiv)="[^"]*"', "", page)
    for svg in svgs(page):
        check(svg)
    titles = [re.search("<title>(.*?)</title>", svg)[1] for svg in svgs(page)]
    worst = found.worst().draw
    assert titles == [
        "What PI, SIMC does on 100 plants", f"Draw {worst} beside the plant on paper",
        "Which parameter matters", "How the error is distributed",
    ]  # fmt: skip
    for each in (*found.spread.signals, *(f"draw {worst}", "100 of the seed 1")):
        assert each in words_of(page)


def test_identifiers_of_its_pictures_differ(page):
    names = re.findall(r' id="([^"]*)"', page)
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("name", "how", "pictures"),
    [
        ("three-tanks", {"uncertainty": STILL}, 3),
        ("three-tanks", {"draws": 1, "sensitivity": False}, 3),
        (
            "quadruple-tank",
            {"uncertainty": {**STILL, "outlet_1.area": {"from": "0.3 cm^2", "to": "0.4 cm^2"}}},
            0,
        ),
    ],
    ids=["nothing varies", "one plant", "nothing rests"],
)
def test_a_page_is_made_of_any_answer(name, how, pictures):
    text = robustness_text(found_of(name, **{"draws": 10, **how}))
    assert len(svgs(text)) == pictures
    for svg in svgs(text):
        check(svg)


def test_the_figure_of_python_is_the_fan(found):
    figure = found.plot()
    rows = [axes for axes in figure.axes if axes.get_ylabel()]
    assert [axes.get_ylabel() for axes in rows] == [
        f"{name}\n[V]" for name in ("level_1", "level_2", "pump_1", "pump_2")
    ]
    assert {axes.get_xlabel() for axes in figure.axes[-4:]} <= {"time [s]", "time [min]"}
    named = {text.get_text() for text in figure.legends[0].get_texts()}
    assert named == {
        "5 to 95 % of plants", "25 to 75 % of plants", "median", "on paper", "setpoint",
    }  # fmt: skip


def test_a_band_is_where_the_plants_are(found):
    fan = fan_of(found.loops, 100)
    figure = fan_figure(found.loops, fan)
    window = fan_windows(found.loops, fan)[0]
    low, high = (fan.shares["pump_1"][CHANCES.index(c), window.records] for c in (0.05, 0.95))
    axes = figure.axes[2 * 4]
    heights = axes.collections[0].get_paths()[0].vertices[:, 1]
    assert heights.min() == pytest.approx(low.min()) and heights.max() == pytest.approx(high.max())
    bottom, top = axes.get_ylim()
    assert bottom < low.min() and high.max() < top


def test_each_kind_of_event_has_one_column_and_four_at_most(found):
    fan = fan_of(found.loops, 20)
    windows = fan_windows(found.loops, fan)
    assert [each.title for each in windows] == [
        "Setpoint level_1 +2 cm", "Setpoint level_2 +2 cm",
        "Load inflow_1 +1.5 cm³/s", "Load inflow_2 +1.5 cm³/s",
    ]  # fmt: skip
    first = found.loops.scenario.segments[0]
    times = fan.time[windows[0].records]
    assert times[0] < first.start < times[-1] <= first.stop and len(times) <= 200


def test_a_scenario_without_events_is_one_column():
    plant = cl.load("three-tanks")
    controller = cl.design.simc(plant)
    loops = cl.robustness(controller, plant, [], duration="5 min", draws=5).loops
    fan = fan_of(loops, 5)
    (window,) = fan_windows(loops, fan)
    assert window.records[[0, -1]].tolist() == [0, len(fan.time) - 1]
    check(svg_text(fan_figure(loops, fan), "no event", "p"))


def test_a_replay_shows_the_runs(found):
    worst, own = found.run(found.worst().draw), found.run(0)
    figure = replay_figure(worst, own, "draw 42")
    axes = next(each for each in figure.axes if each.get_title(loc="left") == "level_1")
    lines = {line.get_label(): np.asarray(line.get_ydata()) for line in axes.lines}
    every = -(-own.samples // 600)
    np.testing.assert_allclose(lines["draw 42"], worst.true_measurement("level_1")[::every])
    np.testing.assert_allclose(lines["on paper"], own.true_measurement("level_1")[::every])
    assert axes.get_ylabel() == "V" and len(lines["on paper"]) <= 600


def test_a_run_that_breaks_is_drawn_as_far_as_it_goes(found):
    run = found.run(1)
    broken = {name: values.copy() for name, values in run.values.items()}
    for values in broken.values():
        values[2000:] = np.nan
    broken["pump_1"][1999] = np.inf
    svg = svg_text(replay_figure(replace(run, values=broken), found.run(0), "draw 1"), "t", "p")
    check(svg)


def test_bars_are_in_order_with_their_intervals():
    total = {f"p{n}": SobolIndex(n / 100.0, n / 200.0, n / 50.0) for n in range(20)}
    (axes,) = causes_figure(Sensitivity(total, total, 512, 0, True)).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        f"p{n}" for n in range(19, 7, -1)
    ]
    bars = next(each for each in axes.containers if len(each) == 12)
    assert [bar.get_width() for bar in bars] == pytest.approx(list(range(19, 7, -1)))
    (segments,) = [
        each.get_segments() for each in axes.collections if hasattr(each, "get_segments")
    ]
    assert segments[0][:, 0].tolist() == pytest.approx([9.5, 38.0])
    assert "[%]" in axes.get_xlabel()


def test_the_longest_name_has_room():
    total = {"outlet_1.discharge": SobolIndex(1.0, 0.9, 1.0), "a": SobolIndex(0.0, 0.0, 0.0)}
    figure = settle(causes_figure(Sensitivity(total, total, 512, 0, True)))
    figure.set_dpi(1440.0)  # as wide as outlines are
    figure.draw_without_rendering()
    assert min(label.get_window_extent().x0 for label in figure.axes[0].get_yticklabels()) >= 0.0


def test_names_are_text():
    total = {"<b>a $x_1$ & b": SobolIndex(1.0, 0.9, 1.0)}
    svg = svg_text(causes_figure(Sensitivity(total, total, 512, 0, True)), "a < b", "p")
    tree.fromstring(svg)
    assert "<b>" not in svg


def test_the_curve_is_the_share_of_plants_below():
    (axes,) = distribution_figure(Distribution.of(np.linspace(0.5, 1.5, 101))).axes
    curve = next(line for line in axes.lines if line.get_label() == "plants at or below")
    errors, shares = (np.asarray(values) for values in curve.get_data())
    assert shares[np.searchsorted(errors, 1.0)] == pytest.approx(100.0 * 51 / 101)
    assert shares[-1] == 100.0 and axes.get_ylabel() == "share of plants [%]"


@pytest.mark.parametrize("broken", [1, 30, 100])
def test_loops_that_break_are_beyond_the_axis(broken):
    errors = np.concatenate([np.linspace(0.9, 1.2, 100 - broken), np.full(broken, np.inf)])
    figure = distribution_figure(Distribution.of(errors))
    check(svg_text(figure, "distribution", "p"))
    (axes,) = figure.axes
    assert np.isfinite(axes.get_xlim()).all()
    assert any("∞ →" in text.get_text() for text in axes.texts)
    curve = next(line for line in axes.lines if line.get_label() == "plants at or below")
    shares = np.asarray(curve.get_ydata())
    assert not len(shares) or shares[-1] == 100.0 - broken


def test_one_plant_that_is_far_worse_does_not_press_the_others_flat():
    errors = np.linspace(0.9, 1.2, 1000)
    errors[-1] = 1e6
    (axes,) = distribution_figure(Distribution.of(errors)).axes
    assert axes.get_xlim()[1] < 2.0
    assert any("draw 999" in text.get_text() and "→" in text.get_text() for text in axes.texts)


def test_what_is_different_is_said_by_its_share_of_paper(found):
    draw = found.worst(ERROR).draw
    table = differences_table(found, draw)
    signals, values = found.spread.signals, found.values(draw)
    shares = {name: values[name] / signal.initial - 1.0 for name, signal in signals.items()}
    first = max(shares, key=lambda name: abs(shares[name]))
    told = f"{100.0 * shares[first]:+.1f} %".replace("-", "−")
    assert table.rows[0][0] == first and table.rows[0][3] == told
    assert {"splitter_1.tank_1", "splitter_2.tank_2"} <= {row[0] for row in table.rows}
    assert 5 <= len(table.rows) <= 7
