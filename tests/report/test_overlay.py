"""What the charts of a study show: which signals, which of their samples, and how they are told."""

from pathlib import Path

import numpy as np
import pytest
from flow_cascade import flow_cascade

import clepsydra as cl
from clepsydra.loop.scenario import Segment
from clepsydra.report.figures import figures_of
from clepsydra.report.overlay import event_title, event_windows, overlay_data, shown_signals
from clepsydra.report.overlay_picture import event_charts

DRUM = Path(__file__).parents[2] / "docs" / "examples" / "surge-drum.toml"


def data_of(result):
    signals, first = shown_signals(result), list(result.ranking[:2])
    return overlay_data(result, signals, event_windows(result, signals, first), first)


@pytest.fixture(scope="module")
def drum():
    plant = cl.load(DRUM)
    return cl.study(plant, [cl.design.arrest_time(plant)])


def test_of_an_averaging_level_the_outflow_comes_first_and_the_band_is_told(drum):
    data = data_of(drum)
    flow, level = data["signals"]
    assert (flow["name"], level["name"]) == ("outflow", "level")
    assert flow["band"] is None
    assert (level["unit"], level["band"]) == ("%", pytest.approx([30.0, 70.0]))  # as in the file
    rows = dict(zip(("outflow", "level"), shown_signals(drum), strict=True))
    run = drum.best.run
    metres = run.values["drum.level"]
    assert rows["level"].values(run) == pytest.approx(50.0 * metres)  # 2 m are 100 %
    assert rows["level"].setpoint(run) == pytest.approx(100.0 * run.values["level.setpoint"])


def test_a_volume_is_shown_in_cubic_metres_whatever_its_level():
    plant = cl.load("averaging-tank")
    result = cl.study(plant, [cl.design.simc(plant)])
    told = {each["name"]: each["unit"] for each in data_of(result)["signals"]}
    assert told["volume"] == "m³" and "tank.level" not in told
    step = Segment("setpoint", "volume", 0.0, 9.0, 0.4)
    assert event_title(plant.process, step) == "Setpoint volume +0.4 m³"
    deviates = next(each for each in figures_of(plant.process) if each.title == "deviates")
    assert deviates.text(plant.process, "volume", 0.0112).startswith("0.011 m³ (")


def test_the_still_picture_has_a_load_either_way_and_the_ends_of_the_band(drum):
    signals, first = shown_signals(drum), list(drum.ranking)
    windows = event_windows(drum, signals, first)
    sizes = [3600.0 * w.segment.size for w in windows if not w.again and w.segment.kind == "load"]
    assert sizes == pytest.approx([10.0, -15.0])
    assert [w.again for w in windows if w.segment.kind == "setpoint"] == [False, True]
    for window in windows:
        flow, level = event_charts(window, signals, first)
        assert flow.band == () and level.band == pytest.approx((30.0, 70.0))
        assert level.ends[0] < 30.0 and level.ends[1] > 70.0


def test_in_the_still_picture_what_looks_like_motion_is_motion(result):
    signals, first = shown_signals(result), list(result.ranking[:2])
    events = [event_charts(each, signals, first) for each in event_windows(result, signals, first)]
    spans = np.array([[np.ptp(chart.ends) for chart in charts[:2]] for charts in events])
    shares = spans.min(axis=1) / spans.max(axis=1)  # of two levels of 20 cm
    assert np.all(shares >= 0.3 - 1e-9) and shares.min() == pytest.approx(0.3)
    setpoint, *own = events[0][0].curves
    assert setpoint.dashes and len(own) == 2
    assert np.ptp(own[0].y) > 2.0


def test_a_cascade_has_a_row_for_what_its_inner_loop_measures(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(flow_cascade(), encoding="utf-8")
    result = cl.study(path)
    data = data_of(result)
    row = [each["name"] for each in data["signals"]].index("duty_flow")
    event, run = data["events"][0], result.best.run
    trace = event["traces"][row]
    places = np.cumsum(event["samples"]) + round(
        result.scenario.segments[0].start / result.scenario.sampling_period
    )
    factor = {"l/s": 1e3, "m³/s": 1.0}[data["signals"][row]["unit"]]
    wanted = factor * run.values["duty_flow.inner_setpoint"][places]
    (own,) = trace["setpoints"]
    assert np.cumsum(own) * trace["step"] == pytest.approx(wanted, abs=0.51 * trace["step"])


def test_a_window_ends_when_the_first_controllers_have_settled(result):
    signals, first = shown_signals(result), result.ranking[:1]
    for window in event_windows(result, signals, first):
        if window.segment.kind == "noise":
            continue
        start, stop = round(window.segment.start), round(window.segment.stop)
        levels = ("tank_1.level", "tank_2.level")
        away = [first[0].run.values[name][start:stop] for name in levels]
        away = [np.abs(level - level[-1]) for level in away]
        late = [each[round(window.view[1]) :] for each in away]
        assert np.max(late, initial=0.0) < 0.05 * np.max(away)
        assert window.view[0] == pytest.approx(-0.06 * window.view[1])
        assert np.all(np.diff(window.samples) > 0)


def test_what_is_not_finite_is_null(result):
    signals, first = shown_signals(result), list(result.ranking)
    windows = event_windows(result, signals, first)
    run = first[0].run
    levels = run.values["tank_1.level"].copy()
    run.values["tank_1.level"][70] = np.nan
    try:
        data = overlay_data(result, signals, windows[:1], first)
    finally:
        run.values["tank_1.level"] = levels
    coded = data["events"][0]["traces"][0]["curves"][0]
    places = np.cumsum(data["events"][0]["samples"]) + 60
    assert coded.count(None) == 1 and places[coded.index(None)] == 70
