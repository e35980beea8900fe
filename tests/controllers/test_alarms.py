"""Alarms come and return when arithmetic says so, on ramps, steps and chattering signals."""

import math

import numpy as np
import pytest
from alarm_rig import alarms_of, scanned, times_of

TIME = np.arange(200.0)
#: Up by 1 m/s from 0 to 100 m, then down again.
UP_AND_DOWN = np.minimum(TIME, 200.0 - TIME)
#: Every second scan above 50 m, the others below by 1 m.
CHATTER = np.where((TIME >= 20) & (TIME < 120), np.where(TIME % 2 == 0, 50.5, 49.5), 40.0)
STEPS = np.where((TIME >= 30) & (TIME < 90), 80.0, 20.0)


def _high(deadband="0 m", on="0 s", off="0 s", limit="50 m"):
    delays = f'on_delay = "{on}", off_delay = "{off}"'
    return f'high = {{ limit = "{limit}", deadband = "{deadband}", {delays} }}'


#: Alarms, a signal, and when the first alarm comes and returns, by hand: a ramp of 1 m/s is at
#: 50 m at 50 s and again at 150 s; below 50 m it is a scan later, and d m below another d s.
SCENARIOS = {
    "high on a ramp": (_high(), UP_AND_DOWN, [50, 151]),
    "high with a deadband": (_high("5 m"), UP_AND_DOWN, [50, 156]),
    "high with an on-delay": (_high(on="7 s"), UP_AND_DOWN, [57, 151]),
    "high with an off-delay": (_high(off="7 s"), UP_AND_DOWN, [50, 158]),
    "high with all of them": (_high("5 m", "3 s", "4 s"), UP_AND_DOWN, [53, 160]),
    "high in percent of the range": (_high("2 %", limit="70 %"), UP_AND_DOWN, [70, 133]),
    "high-high": ('high_high = { limit = "90 m", deadband = "1 m" }', UP_AND_DOWN, [90, 112]),
    "low on a ramp": ('low = { limit = "30 m", deadband = "0 m" }', UP_AND_DOWN, [0, 31, 170]),
    "low with a deadband": (
        'low = { limit = "30 m", deadband = "4 m" }', UP_AND_DOWN, [0, 35, 170],
    ),
    "low-low with an on-delay": (
        'low_low = { limit = "10 m", deadband = "0 m", on_delay = "5 s" }', UP_AND_DOWN,
        [5, 11, 195],
    ),
    "a limit that is met exactly": (_high(limit="80 m"), STEPS, [30, 90]),
    "a step that is shorter than the on-delay": (_high(on="61 s"), STEPS, []),
    "a step as long as the on-delay": (_high(on="59 s"), STEPS, [89, 90]),
    "a chattering signal": (_high("2 m"), CHATTER, [20, 120]),
    "a chattering signal with an off-delay": (_high(off="3 s"), CHATTER, [20, 122]),
    "a chattering signal with an on-delay": (_high(on="2 s"), CHATTER, []),
    "deviation from 50 m": (
        'deviation = { limit = "20 m", deadband = "0 m", on_delay = "2 s" }',
        np.where(TIME < 100, 50.0, 50.0 + (TIME - 100.0)), [122],
    ),
    "deviation on either side": (
        'deviation = { limit = "30 m", deadband = "5 m" }', STEPS, [0],
    ),
    "rate of change of a ramp of 2 m/s": (
        'rate = { limit = "1.5 m/s" }',
        np.clip(2.0 * (TIME - 40.0), 0.0, 60.0), [41, 71],
    ),
    "rate of change of a level that falls by 2 m/s": (
        'rate = "1.5 m/s"', 90.0 - np.clip(2.0 * (TIME - 40.0), 0.0, 60.0), [41, 71],
    ),
    "rate of change of a level that stands": ('rate = "1.5 m/s"', np.full(200, 80.0), []),
    "rate of change within the limit": ('rate = "1.5 m/s"', UP_AND_DOWN, []),
    "rate of change with an on-delay": (
        'rate = { limit = "1.5 m/s", on_delay = "4 s" }',
        np.clip(2.0 * (TIME - 40.0), 0.0, 60.0), [45, 71],
    ),
    "flatline from when the pump moves": (
        'flatline = "20 s"', np.where(TIME < 30, TIME, np.where(TIME < 100, 30.0, 31.0)),
        [80, 100],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENARIOS)
def test_an_alarm_comes_and_returns_when_it_should(name, tmp_path):
    written, level, times = SCENARIOS[name]
    pump = np.where(TIME < 60, 2.0, 4.0)
    told = scanned(
        alarms_of(tmp_path, written), level, **{"level_1.sp": 50.0, "pump_1.command": pump}
    )
    (active,) = (column for name, column in told.items() if name.endswith(".active"))
    assert times_of(active) == times


def test_there_are_twenty_scenarios():
    assert len(SCENARIOS) >= 20


def test_the_filter_of_a_rate_is_of_first_order(tmp_path):
    """A ramp of r behind a filter of time T shows r (1 − (T/(T + Δt))ᵏ) after k steps."""
    written = 'rate = { limit = "1.5 m/s", filter_time = "10 s" }'
    told = scanned(alarms_of(tmp_path, written), np.minimum(2.0 * TIME, 100.0))
    k = math.ceil(math.log(1.0 - 1.5 / 2.0) / math.log(10.0 / 11.0))
    assert times_of(told["level_1.rate.active"])[0] == k


@pytest.mark.parametrize("step", [0.1, 0.7, 3.0])
def test_a_delay_of_whole_scans_ends_at_its_scan(step, tmp_path):
    """Sums of 0.1 s are no multiples of it; a delay of ten scans takes ten all the same."""
    controller = alarms_of(tmp_path, _high(on=f"{10 * step:g} s"))
    told = scanned(controller, np.full(40, 60.0), step)
    assert np.flatnonzero(told["level_1.high.active"])[0] == 10


@pytest.mark.parametrize("bad", [{"level_1.good": 0.0}, {"time_step": 0.0}])
def test_what_is_not_known_leaves_an_alarm_and_its_delay_as_they_are(bad, tmp_path):
    controller = alarms_of(tmp_path, _high(on="5 s", off="5 s"))
    (name,) = bad
    known = np.where((TIME >= 53) & (TIME < 63), bad[name], 1.0)
    told = scanned(controller, UP_AND_DOWN, **{name: known})
    assert times_of(told["level_1.high.active"]) == [65, 156]


def test_a_measurement_that_is_no_number_leaves_every_alarm_as_it_is(tmp_path):
    written = 'high = "50 m"\nlow = "30 m"\nrate = "5 m/s"\ndeviation = "40 m"\nflatline = "9 s"'
    controller = alarms_of(tmp_path, written)
    pump = {"pump_1.command": np.where(TIME < 60, 2.0, 4.0), "level_1.sp": 50.0}
    gap = np.s_[20:90]
    broken = np.where((TIME >= 20) & (TIME < 90), math.nan, 20.0)
    told = scanned(controller, broken, **pump)
    without = {name: np.delete(np.broadcast_to(c, TIME.shape), gap) for name, c in pump.items()}
    kept = scanned(controller, np.delete(broken, gap), **without)
    assert np.array_equal(told.pop("level_1.watched") > 0, ~np.isnan(broken))
    for name, column in told.items():
        assert np.all(column[20:90] == column[19]), name
        assert np.array_equal(np.delete(column, np.s_[20:90]), kept[name]), name


@pytest.mark.parametrize("part", ["limit", "deadband", "on_delay"])
def test_a_parameter_that_is_no_number_is_seen(part, tmp_path):
    """In a plant it may be set to anything: an alarm that never came would not be missed."""
    controller = alarms_of(tmp_path, _high(on="5 s"))
    controller.values[f"level_1.high.{part}"] = math.nan
    told = scanned(controller, np.where(TIME < 20, 60.0, 40.0))
    assert np.any(told["level_1.high.active"])


def test_an_alarm_is_acknowledged_as_isa_18_2_has_it(tmp_path):
    """States: 1 unacknowledged, 2 acknowledged, 3 returned unacknowledged, 0 normal."""
    controller = alarms_of(tmp_path, 'high = { limit = "50 m", acknowledged = true }')
    level = np.array([40, 60, 60, 60, 40, 40, 60, 40, 40, 40, 60], float)
    button = np.array([0, 0, 1, 1, 1, 0, 0, 0, 1, 0, 1], float)
    told = scanned(controller, level, acknowledge=button)
    assert told["level_1.high.state"].tolist() == [0, 1, 2, 2, 0, 0, 1, 3, 0, 0, 1]


def test_a_button_that_is_held_acknowledges_once(tmp_path):
    controller = alarms_of(tmp_path, 'high = { limit = "50 m", acknowledged = true }')
    level = np.array([60, 60, 40, 60, 60], float)
    told = scanned(controller, level, acknowledge=np.array([0, 1, 1, 1, 1], float))
    assert told["level_1.high.state"].tolist() == [1, 2, 0, 1, 1]


def test_an_interlock_of_an_acknowledged_alarm_waits_for_its_acknowledgement(tmp_path):
    written = 'high_high = {{ limit = "50 m", interlock = {{ pump_1 = "0 V" }}{} }}'
    level = np.array([40, 60, 40, 40, 40], float)
    free = scanned(alarms_of(tmp_path, written.format("")), level)
    kept = scanned(
        alarms_of(tmp_path, written.format(", acknowledged = true")), level,
        acknowledge=np.array([0, 0, 0, 1, 1], float),
    )  # fmt: skip
    assert free["pump_1.interlock"].tolist() == [0, 1, 0, 0, 0]
    assert kept["pump_1.interlock"].tolist() == [0, 1, 1, 0, 0]


def test_a_flatline_forgets_the_pump_when_the_measurement_moves(tmp_path):
    controller = alarms_of(tmp_path, 'flatline = { time = "20 s", still = "0.5 m" }')
    pump = np.where(TIME < 60, 2.0, 4.0)
    level = np.where(TIME < 70, 30.0, 31.0) + 0.4 * (TIME % 2)
    told = scanned(controller, level, **{"pump_1.command": pump})
    assert times_of(told["level_1.flatline.active"]) == []
    stuck = scanned(controller, 30.0 + 0.4 * (TIME % 2), **{"pump_1.command": pump})
    assert times_of(stuck["level_1.flatline.active"]) == [80]
