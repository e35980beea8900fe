"""A storm-water basin whose level is told late and seldom, and whose high-high opens its gate.

T q′ = ψ A i − q of the rain i, and A dh/dt = q − Kv s √((h + 0.5 m) ρ g / 1 bar) − 2/3 c b √(2 g)
(h − 2.5 m)^(3/2), the last where it spills. Alarms are looked at before the loop goes on.
"""

from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model

import clepsydra as cl

FILE = Path(__file__).with_name("storm-basin.toml")
PERIOD = 5.0
TOWN, DELAYED, AREA, RANGE = 0.6 * 3000.0, 480.0, 40.0, 2.5
GATE = 130.0 / 3600.0 * np.sqrt(9.81 / 100.0)
WEIR = 2.0 / 3.0 * 0.62 * 3.0 * np.sqrt(2.0 * 9.81)
MILLIMETRES_AN_HOUR = 1e-3 / 3600.0
RAIN, LEVEL = 6.0, 1.2
LATE, EVERY, FIRST = 2, 4, 3
#: Time from the beginning of the rain [min] and rain [mm/h].
COURSE = ((0.0, 110.0), (28.0, 30.0), (45.0, 2.0))
STUDY = """
process = {file}
[scenario]
duration = "2 h"
noise = false
[[scenario.load]]
signal = "town"
at = "5 min"
profile = "rain.csv"
[controllers.loop.loops.level]
measurement = "level"
output = "gate"
actions = "PI"
action = "direct"
gain = "0.4 %/%"
integral_time = "1 h"
"""


class Alarm:
    """An alarm of a high level: it comes and returns after delays, of whole samples."""

    def __init__(self, limit, deadband, on=0, off=0):
        self.limit, self.back, self.delays = limit, limit - deadband, (on, off)
        self.active, self.waited = False, 0

    def __call__(self, level):
        changes = level <= self.back if self.active else level >= self.limit
        if changes and self.waited >= self.delays[self.active]:
            self.active, self.waited = not self.active, 0
        else:
            self.waited = self.waited + 1 if changes else 0
        return self.active


def rates(state, inputs, rain=RAIN, time=0.0):
    level, runoff = state
    spilt = WEIR * max(level - RANGE, 0.0) ** 1.5
    out = GATE * inputs[0] * np.sqrt(level + 0.5) + spilt
    caught = TOWN * rain * MILLIMETRES_AN_HOUR
    return np.array([(runoff - out) / AREA, (caught - runoff) / DELAYED])


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def at_rest():
    runoff = TOWN * RAIN * MILLIMETRES_AN_HOUR
    return np.array([LEVEL, runoff]), runoff / GATE / np.sqrt(LEVEL + 0.5)


def test_it_rests_where_the_gate_lets_the_runoff_go(plant, at_rest):
    (_, runoff), gate = at_rest
    found = plant.point.as_dict()
    assert (found["town.runoff"], found["gate"]) == pytest.approx((runoff, gate), rel=1e-9)


def test_its_gain_and_time_constants(plant, at_rest):
    state, gate = at_rest
    gain, times = model(rates, lambda state, inputs: state[:1], state, np.array([gate]))
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain, rel=1e-6)
    assert found.time_constants == pytest.approx(times, rel=1e-6)
    assert found.dead_times == pytest.approx(10.0 + (20.0 - PERIOD) / 2.0)


def test_its_loop_and_its_alarms_run_as_computed(tmp_path, at_rest):
    rows = "".join(f"{time},{rain}\n" for time, rain in COURSE)
    (tmp_path / "rain.csv").write_text(f"time [min],town [mm/h]\n{rows}", encoding="utf-8")
    file = tmp_path / "storm.toml"
    file.write_text(STUDY.format(file=repr(str(FILE))), encoding="utf-8")
    run = cl.study(file)["loop"].run
    state, gate = at_rest
    loop = PI(-0.4, 3600.0, PERIOD, gate)
    alarms = {"high_high": Alarm(1.9, 0.05, on=4), "high": Alarm(1.6, 0.05, off=12)}
    told, read, found = LEVEL, [], []
    for sample in range(len(run.time)):
        since = PERIOD * sample / 60.0 - 5.0
        rain = next((rain for time, rain in reversed(COURSE) if since >= time), RAIN)
        read.append(min(state[0], RANGE))  # the meter ends at the rim
        if sample >= FIRST and (sample - FIRST) % EVERY == 0:
            told = read[max(sample - LATE, 0)]
        active = [alarm(told) for alarm in alarms.values()]
        moved = loop(LEVEL / RANGE, told / RANGE, held_at=1.0 if active[0] else None)
        found.append((*state, told, moved, *active))
        state = advanced(rates, state, ([moved], rain), PERIOD)
    level, runoff, told, moved, *active = np.array(found).T
    assert np.abs(run.values["basin.level"] - level).max() < 1e-6 * RANGE
    assert np.abs(run.values["level"] - told).max() < 1e-6 * RANGE
    assert np.abs(run.values["town.runoff"] - runoff).max() < 1e-6 * runoff.max()
    assert np.abs(run.values["gate"] - moved).max() < 1e-6
    for name, expected in zip(alarms, active, strict=True):
        assert np.array_equal(run.values[f"level.{name}.active"], expected), name
        said = f"{name.replace('_', '-')} alarm"
        (alarm,) = (each for each in run.alarms if each.words.startswith(said))
        assert alarm.count == np.sum(np.diff(expected) > 0) >= 1
        assert alarm.duration == PERIOD * np.sum(expected)
    assert np.array_equal(run.values["gate.interlock"], active[0])
    assert level.max() > RANGE + 0.01 and 0 < np.sum(active[0]) < np.sum(active[1])
