"""The report of an open-loop simulation."""

import re
from dataclasses import replace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.process.catalogue_names import catalogue_file
from clepsydra.report.colours import INK, signal_colours
from clepsydra.report.page import write_page
from clepsydra.report.recording import all_panels, event_marks
from clepsydra.report.simulation_page import (
    balances_grid,
    change_words,
    events_grid,
    simulation_text,
    trajectories_grid,
    trust_sentence,
)
from clepsydra.report.trends import plot


def simulated(name, *events, duration=None):
    return cl.simulate(cl.load(name), None, events, duration=duration)


@pytest.fixture(scope="module")
def step():
    return simulated(
        "quadruple-tank",
        cl.step("pump_1", to="3.5 V", at="60 s"),
        cl.step("inflow_1", to="2 cm^3/s", at="2 min"),
    )


@pytest.fixture(scope="module")
def trips():
    more = cl.step("pump_1", to="90 %", at="5 s")
    return simulated("laboratory-four-tanks", more, duration="60 s")


def seconds(text):
    """What a time in a table says."""
    number, unit = text.split(" ")
    return float(number) * {"s": 1.0, "min": 60.0}[unit]


def test_panels_are_states_inputs_and_disturbances_that_act(step):
    names = [panel.signal.name for panel in all_panels(step)]
    assert names == [
        "tank_1.level", "tank_2.level", "tank_3.level", "tank_4.level", "pump_1", "pump_2",
        "inflow_1",
    ]  # fmt: skip


def test_states_that_are_no_levels_have_no_rim():
    run = simulated("averaging-tank", duration="5 s")
    kinds = {panel.signal.name: panel.kind for panel in all_panels(run)}
    assert (kinds["tank.level"], kinds["tank.impurity"]) == ("level", "state")
    words = [text.get_text() for axes in plot(run).axes for text in axes.texts]
    assert sum(text.startswith("rim") for text in words) == 1


def test_one_colour_a_signal_and_shared_time(step):
    figure, colours = plot(step), signal_colours(step.process)
    assert len(figure.axes) == 7  # no strip: there is no scenario
    for axes, panel in zip(figure.axes, all_panels(step), strict=True):
        line = max(axes.lines, key=lambda entry: len(entry.get_xdata()))
        assert line.get_color() == colours[panel.signal.name]
        assert np.allclose(line.get_xdata(), step.time / 60)
    assert figure.axes[-1].get_xlabel() == "time [min]"
    assert {axes.get_xlim()[1] for axes in figure.axes} == {step.time[-1] / 60}


def hairlines(axes):
    collections = [c for c in axes.collections if len(c.get_segments())]
    return [float(s[0, 0]) for c in collections for s in c.get_segments()]


@pytest.mark.thorough
def test_events_are_hairlines_where_they_happen(trips):
    times = [mark.time for mark in event_marks(trips.events)]
    assert times
    for axes in plot(trips).axes:
        assert np.allclose(sorted(set(hairlines(axes))), sorted(set(times)), rtol=0, atol=1e-9)
    numbers = [text.get_text() for text in plot(trips).axes[0].texts]
    numbers = [int(number.split()[0]) for number in numbers]
    assert numbers[0] == 1 and numbers == sorted(numbers)


def test_without_events_there_are_no_hairlines(step):
    assert not any(hairlines(axes) for axes in plot(step).axes)


def test_events_do_not_change_the_range_of_a_panel(trips):
    axes = plot(trips).axes[1]
    bottom, top = axes.get_ylim()
    low, high = (100 * f(trips.values["tank_1.level"]) for f in (np.min, np.max))
    assert bottom >= -0.31 and top <= 30.31 and bottom < low <= high < top


def test_a_pump_at_its_limit_is_marked_with_the_time():
    moves = (("10 V", "20 s"), ("3 V", "50 s"))
    events = [cl.step("pump_1", to=value, at=at) for value, at in moves]
    run = simulated("quadruple-tank", *events, duration="60 s")
    axes = plot(run).axes[4]
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "at a limit for 30 s" in words
    assert any(patch.get_facecolor()[:3] == pytest.approx(rgb(INK)) for patch in axes.patches)


def rgb(colour):
    return tuple(int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))


@pytest.mark.thorough
def test_the_page_says_all_of_it(trips):
    page = simulation_text(trips.plan, trips)
    assert "with pump_1 to 90 % at 5 s" in page and trust_sentence(trips) in page
    for event in trips.events[:5]:
        assert event.words in page
    assert page.count("<svg") == 2
    for name in ("tank_1.level", "level_1", "pump_1"):
        assert f">{name}</th>" in page


@pytest.mark.thorough
def test_two_pages_of_one_simulation_are_equal_and_load_nothing(step, tmp_path):
    page = simulation_text(step.plan, step)
    write_page(simulation_text(step.plan, step.plan.run()), tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text("utf-8") == page
    assert "<script" not in page
    assert not re.search(r"(?:src|href)=\"(?!#)", page)


@pytest.mark.thorough
def test_words_of_the_user_are_escaped(tmp_path):
    text = catalogue_file("quadruple-tank").read_text("utf-8")
    path = tmp_path / "a.toml"
    path.write_text(re.sub(r'^title = ".*"$', 'title = "<b>x</b>"', text, flags=re.M), "utf-8")
    run = simulated(path, duration="10 s")
    page = simulation_text(run.plan, run)
    assert "<b>x" not in page and "&lt;b&gt;x" in page


def test_tables_hold_the_numbers_of_the_run(step):
    rows = {row[0]: row[1:] for row in trajectories_grid(step).rows}
    level = 100 * step.values["tank_1.level"]
    assert rows["tank_1.level"][0] == f"{level[0]:.2f} cm"
    assert rows["tank_1.level"][1] == f"{level[-1]:.2f} cm"
    assert rows["tank_3.level"][2:] == ("–", "–")
    assert rows["pump_1"][3] == "3.500 V at 60 s"
    assert "inflow_1" in rows and "inflow_2" not in rows
    (balance,) = step.balances
    assert balances_grid(step).rows[0][1] == f"{balance.entered:.4f} m³"


def test_many_events_are_one_line_and_one_mark(trips):
    """A pump that trips and is released again and again: not a comb of hairlines."""
    trips_of_it = [e for e in trips.events if e.event.startswith("pump_1.trips")]
    rows = events_grid(trips, 12).rows
    assert len(trips_of_it) > 5 and len(rows) < len(trips.events)
    (row,) = [row for row in rows if row[2].startswith(trips_of_it[0].words)]
    count = sum(event.times for event in trips_of_it)
    assert seconds(row[1]) == pytest.approx(trips_of_it[0].time, rel=5e-4)
    times, last = re.search(r"\((\d+) times, the last at (.*)\)$", row[2]).groups()
    assert int(times) == count
    assert seconds(last) == pytest.approx(trips_of_it[-1].time, rel=5e-4)
    for axes in plot(trips).axes:
        assert len(hairlines(axes)) == len(rows)
    assert f"{row[0]} (×{count})" in [text.get_text() for text in plot(trips).axes[0].texts]
    ((dots, _, others),) = events_grid(trips, 0).rows
    number, last = re.fullmatch(r"and (\d+) more, the last at (.*)", others).groups()
    assert (dots, int(number)) == ("…", len(rows))
    assert seconds(last) == pytest.approx(trips.events[-1].time, rel=5e-4)


def test_changes_in_words():
    events = [
        cl.step("pump_1", to="3.2 V", at=0.0),
        cl.step("pump_1", to="3.5 V", at="60 s"),
        cl.ramp("pump_2", to="4 V", at="60 s", over="9 min"),
        cl.step("inflow_1", to="2e-6 m^3/s", at="1 h"),
    ]
    run = simulated("quadruple-tank", *events, duration="61 min")
    assert sorted(change_words(run.process, change) for change in run.plan.changes) == [
        "inflow_1 to 2 cm³/s at 60 min",
        "pump_1 to 3.2 V from the start",
        "pump_1 to 3.5 V at 60 s",
        "pump_2 to 4 V from 60 s to 10 min",
    ]


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (2e-7, "largest error of a state at 2.0e−5 % of its range; the balance"),
        (3e-5, "at 0.0030 % of its range, more than the 1.00e−4 % that was aimed at; the balance"),
        (1.6, "by as much as its whole range: no figure of this run can be relied on"),
        (float("nan"), "The simulation broke down: a state became not a number; the balance"),
        (None, "Integrated by the reference solver to a relative tolerance of 1e−10; the balance"),
    ],
)
def test_how_sure_it_is(step, error, words):
    assert words in trust_sentence(replace(step, error_estimate=error))
