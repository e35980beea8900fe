"""A level over a level, by a pump whose flow is 20 s on its way.

A₁ dh₁/dt = p(t − 20 s) − a₁ √(2 g h₁), A₂ dh₂/dt = a₁ √(2 g h₁) + d − a₂ √(2 g h₂), and the pump
follows its signal with 4 s: within a sample v = u + (v₀ − u) e^(−t/4 s).
"""

from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model

import clepsydra as cl

FILE = Path(__file__).with_name("late-launder.toml")
PERIOD, LATE, LAG, PUMP, RAIN = 5.0, 4, 4.0, 12e-3, 0.5e-3
AREAS = np.array([0.8, 2.5])
HOLES = np.pi / 4.0 * np.array([0.05, 0.055]) ** 2 * np.sqrt(2.0 * 9.81)
RANGE = 1.5
CASCADE = """
process = {file}
[scenario]
duration = "40 min"
noise = false
[[scenario.setpoint]]
signal = "level_2"
at = "1 min"
by = "15 cm"
over = "5 min"
[[scenario.load]]
signal = "rain"
at = "15 min"
profile = "rain.csv"
[controllers.cascade.loops.level_2]
measurement = "level_2"
output = "level_1.setpoint"
actions = "PI"
action = "reverse"
gain = "2 %/%"
integral_time = "8 min"
[controllers.cascade.loops.level_1]
measurement = "level_1"
output = "pump_1"
actions = "PI"
action = "reverse"
gain = "1.5 %/%"
integral_time = "2 min"
"""
#: Time from the beginning of the rain [min] and rain [l/s].
COURSE = ((0.0, 1.5), (3.0, 3.0), (6.0, 2.0), (12.0, 0.5))


def rates(levels, pump, rain=RAIN, begun=None, time=0.0):
    """Return the rates while the pump, as it was when this flow left, goes from `begun` on."""
    running = pump if begun is None else pump + (begun - pump) * np.exp(-time / LAG)
    out = HOLES * np.sqrt(levels)
    return np.array([PUMP * running - out[0], out[0] + rain - out[1]]) / AREAS


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def at_rest():
    """Return both levels [m] and the pump [1]: what leaves is what pump and rain bring."""
    out = HOLES[1] * np.sqrt(0.6)
    return np.array([((out - RAIN) / HOLES[0]) ** 2, 0.6]), (out - RAIN) / PUMP


def test_it_rests_where_inflow_and_outflow_balance(plant, at_rest):
    levels, pump = at_rest
    found = plant.point.as_dict()
    assert [found["tank_1.level"], found["tank_2.level"]] == pytest.approx(levels, rel=1e-9)
    assert found["pump_1"] == pytest.approx(pump, rel=1e-9)


def test_its_gain_and_time_constants(plant, at_rest):
    levels, pump = at_rest
    gain, times = model(
        lambda state, inputs: rates(state, inputs[0]), lambda state, inputs: state[1:],
        levels, np.array([pump]),
    )  # fmt: skip
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain, rel=1e-6)
    assert found.time_constants == pytest.approx([*times, LAG], rel=1e-6)
    assert found.dead_times == pytest.approx(20.0)


def test_its_cascade_runs_as_computed(tmp_path, at_rest):
    """A ramp of the setpoint, and rain as it was recorded."""
    rows = "".join(f"{time},{flow}\n" for time, flow in COURSE)
    (tmp_path / "rain.csv").write_text(f"time [min],rain [l/s]\n{rows}", encoding="utf-8")
    file = tmp_path / "cascade.toml"
    file.write_text(CASCADE.format(file=repr(str(FILE))), encoding="utf-8")
    run = cl.study(file)["cascade"].run
    levels, pump = at_rest
    outer, inner = (
        PI(2.0, 480.0, PERIOD, levels[0] / RANGE), PI(1.5, 120.0, PERIOD, pump)
    )  # fmt: skip
    running, left, found = pump, [(pump, pump)] * LATE, []
    for sample in range(len(run.time)):
        minutes = sample / 12.0
        setpoint = 0.6 + 0.15 * np.clip((minutes - 1.0) / 5.0, 0.0, 1.0)
        rain = next(
            (flow * 1e-3 for time, flow in reversed(COURSE) if minutes >= 15.0 + time), RAIN
        )
        wanted = outer(setpoint / RANGE, levels[1] / RANGE)
        moved = inner(wanted, levels[0] / RANGE)
        found.append((*levels, moved))
        left.append((moved, running))
        running = moved + (running - moved) * np.exp(-PERIOD / LAG)
        asked, begun = left.pop(0)
        levels = advanced(rates, levels, (asked, rain, begun), PERIOD)
    upper, lower, moved = np.array(found).T
    assert np.abs(run.values["tank_1.level"] - upper).max() < 1e-6 * RANGE
    assert np.abs(run.values["tank_2.level"] - lower).max() < 1e-6 * RANGE
    assert np.abs(run.values["pump_1"] - moved).max() < 1e-6
    assert moved.max() < 1.0 and np.ptp(moved) > 0.1 and np.ptp(lower) > 0.1
