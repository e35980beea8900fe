"""Lye and water in a mixer whose analyser tells every 5 min what was in it 40 s before.

dV/dt = l + w + d − k h and d(V c)/dt = 700 g/l l − k h c, with w = Kv s √(2 bar / 1 bar).
"""

from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model

import clepsydra as cl

FILE = Path(__file__).with_name("lye-dilution.toml")
PERIOD = 10.0
AREA, OUTLET = np.pi * 0.8**2, 1.6e-3  # [m²], [m²/s]
PUMP, WATER, DRAIN = 1.5e-3, 6.0 / 3600.0 * np.sqrt(2.0), 1e-4  # [m³/s], at full signals
STORE, LEVEL, STRENGTH = 700.0, 1.2, 200.0  # [g/l], [m], [g/l]
RANGES = np.array([2.0, 400.0])
#: Whole samples of the dead time, between two reports, and to the first one.
LATE, EVERY, FIRST = 4, 30, 12


def rates(state, inputs, drain=DRAIN, time=0.0):
    volume, lye = state
    feed, water = PUMP * inputs[0], WATER * inputs[1]
    out = OUTLET * volume / AREA
    return np.array([feed + water + drain - out, STORE * feed - out * lye / volume])


def shown(state, inputs=None):
    return np.array([state[0] / AREA, state[1] / state[0]]) / RANGES


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def at_rest():
    """Return pump and valve [1]: 700 l = 200 k h, and the rest of k h is water and drain."""
    out = OUTLET * LEVEL
    feed = STRENGTH / STORE * out
    return np.array([feed / PUMP, (out - feed - DRAIN) / WATER])


STATE = np.array([AREA * LEVEL, AREA * LEVEL * STRENGTH])


def test_it_rests_where_lye_and_water_balance(plant, at_rest):
    found = plant.point.as_dict()
    assert found["lye_pump"] == pytest.approx(at_rest[0], rel=1e-9)
    assert found["water_valve"] == pytest.approx(4e-3 + 16e-3 * at_rest[1], rel=1e-9)


def test_its_gain_and_time_constants(plant, at_rest):
    gain, times = model(rates, shown, STATE, at_rest)
    found = cl.analyse(plant)
    units = RANGES[:, None] / [[1.0, 16e-3]]
    assert found.static_gain == pytest.approx(gain * units, rel=1e-5, abs=1e-8)
    assert found.time_constants == pytest.approx(times, rel=1e-5)
    # As old as its reports are on the average: 40 s, and half of 5 min less half a sample.
    assert found.dead_times == pytest.approx(np.array([[0.0, 0.0], [185.0, 185.0]]))


def test_its_loops_run_as_computed(plant, at_rest):
    """The strength goes up, then the drain gives more than it did."""
    controller = cl.design.simc(plant).with_values(
        {"strength": {"K": "0.6 %/%", "Ti": "20 min"}, "level": {"K": "4 %/%", "Ti": "10 min"}}
    )
    events = [
        cl.step("strength", to="230 g/l", at="200 s"),
        cl.disturbance("drain_water", to="16 l/min", at="3000 s"),
    ]
    run = cl.simulate(plant, controller, events, duration="2 h")
    strength_loop = PI(0.6, 1200.0, PERIOD, at_rest[0])
    level_loop = PI(4.0, 600.0, PERIOD, at_rest[1])
    state, told, read, found = STATE, STRENGTH / RANGES[1], [], []
    for sample in range(len(run.time)):
        level, strength = shown(state)
        read.append(strength)
        if sample >= FIRST and (sample - FIRST) % EVERY == 0:
            told = read[max(sample - LATE, 0)]
        moved = (
            strength_loop((200.0 + 30.0 * (sample >= 20)) / RANGES[1], told),
            level_loop(LEVEL / RANGES[0], level),
        )
        found.append((level, strength, told, *moved))
        drain = DRAIN + 10e-3 / 60.0 * (sample >= 300)
        state = advanced(rates, state, (moved, drain), PERIOD)
    level, strength, told, pump, valve = np.array(found).T
    for name, expected, span in (
        ("mixer.level", level, RANGES[0]),
        ("mixer.lye", strength, RANGES[1]),
        ("strength", told, RANGES[1]),
        ("lye_pump", pump, 1.0),
        ("water_valve", valve + 0.25, 16e-3),
    ):
        assert np.abs(run.values[name] / span - expected).max() < 1e-6, name
    assert np.ptp(strength) > 0.05 and len(np.unique(told)) > 20
