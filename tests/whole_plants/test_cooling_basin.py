"""The basin of a cooling tower, filled in units of the United States.

A dh/dt = w + r − e A − c a √(2 g (h − 4 in)), with w = Kv √s √(p / 1 bar) through a quick-opening
valve, whose p is 700 inH2O and that of 6 ft of water; the level meter follows with 8 s. Below 1 %
of the stroke the root has the odd polynomial of degree five that meets it there smoothly.
"""

from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model

import clepsydra as cl

FILE = Path(__file__).with_name("cooling-basin.toml")
PERIOD = 4.0
FOOT = 0.3048
GPM, CFM = 231.0 * 0.0254**3 / 60.0, FOOT**3 / 60.0
AREA, RANGE = 220.0 * FOOT**2, 5.0 * FOOT
#: Of water at 4 °C under standard gravity.
PRESSURE = 700.0 * 0.0254 * 1000.0 * 9.80665 + 6.0 * FOOT * 1000.0 * 9.81
WATER, LAG, LAG_OF_METER = 90.0 * GPM * np.sqrt(PRESSURE / 1e5), 6.0, 8.0
DRY, RAIN = 1.2 * 0.0254 / 3600.0, 1.5 * CFM
HOLE = 0.62 * np.pi / 4.0 * (2.0 * 0.0254) ** 2 * np.sqrt(2.0 * 9.81)
LEVEL = 3.0 * FOOT


def leaves(level):
    return DRY * AREA + HOLE * np.sqrt(level - 4.0 * 0.0254)


def opened(stroke):
    if stroke >= 0.01:
        return np.sqrt(stroke)
    share = max(stroke, 0.0) / 0.01
    return 0.1 * (45.0 * share - 18.0 * share**3 + 5.0 * share**5) / 32.0


def rates(state, inputs, rain=RAIN, time=0.0):
    level, opening, told = state
    filled = WATER * opened(opening) + rain - leaves(level)
    return np.array(
        [filled / AREA, (inputs[0] - opening) / LAG, (level - told) / LAG_OF_METER]
    )  # fmt: skip


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def opening():
    return ((leaves(LEVEL) - RAIN) / WATER) ** 2


def test_it_rests_where_the_main_makes_up_for_what_leaves(plant, opening):
    found = plant.point.as_dict()
    assert found["basin.level"] == pytest.approx(LEVEL, rel=1e-12)
    assert found["LV7"] == pytest.approx(4e-3 + 16e-3 * opening, rel=1e-6)


def test_its_gain_and_time_constants(plant, opening):
    gain, times = model(
        rates, lambda state, inputs: state[2:] / RANGE,
        np.array([LEVEL, opening, LEVEL]), np.array([opening]),
    )  # fmt: skip
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain / 16e-3, rel=1e-5)
    assert found.time_constants == pytest.approx(times, rel=1e-5)


def test_its_loop_runs_as_computed(plant, opening):
    """The setpoint falls in a ramp, and in the end it rains."""
    controller = cl.design.simc(plant).with_values({"LT7": {"K": "30 %/%", "Ti": "5 min"}})
    events = [
        cl.ramp("LT7", to="55 %", at="40 s", over="200 s"),
        cl.disturbance("rain", to="18 cfm", at="1000 s"),
    ]
    run = cl.simulate(plant, controller, events, duration="30 min")
    loop = PI(30.0, 300.0, PERIOD, opening)
    state, found = np.array([LEVEL, opening, LEVEL]), []
    for sample in range(len(run.time)):
        setpoint = 0.6 - 0.05 * np.clip((sample - 10) / 50.0, 0.0, 1.0)
        moved = loop(setpoint, state[2] / RANGE)
        found.append((state[0], state[2], moved))
        state = advanced(rates, state, ([moved], RAIN + 16.5 * CFM * (sample >= 250)), PERIOD)
    level, told, moved = np.array(found).T
    assert np.abs(run.values["basin.level"] - level).max() < 1e-6 * RANGE
    assert np.abs(run.values["LT7"] - told / RANGE).max() < 1e-6
    assert np.abs(run.values["LV7"] - (4e-3 + 16e-3 * moved)).max() < 1e-6 * 16e-3
    assert np.ptp(moved) > 0.3 and np.ptp(level) > 0.05
