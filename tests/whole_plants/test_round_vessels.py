"""Three vessels whose surface changes with their level: V' = Σ q_in − Σ q_out, A(h) h' = V'.

The surface of a sphere is π h (D − h), that of a lying drum 2 L √(h (D − h)), and between two
points of a measured pit it is a straight line.
"""

from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model

import clepsydra as cl

FILE = Path(__file__).with_name("round-vessels.toml")
PERIOD = 2.0
PUMP, WASH = 8e-3, 0.2e-3
VALVE = 50.0 / 3600.0 * np.sqrt(9.81 / 100.0)  # per √m of a metre of water
HOLES = 0.65 * np.array([12e-4, 14e-4]) * np.sqrt(2.0 * 9.81)
RANGES = np.array([1.6, 1.2])
PIT = np.array([[0.0, 0.6], [0.5, 0.9], [1.0, 1.6], [1.5, 1.8]])
LEVELS = np.array([0.9, 0.5])


def rates(levels, inputs, wash=WASH, time=0.0):
    sphere, drum, pit = levels
    surfaces = np.array([
        np.pi * sphere * (1.6 - sphere), 2.0 * 2.5 * np.sqrt(drum * (1.2 - drum)),
        np.interp(pit, *PIT.T),
    ])  # fmt: skip
    fed, moved = PUMP * inputs[0], VALVE * inputs[1] * np.sqrt(sphere + 0.8)
    out = HOLES * np.sqrt([drum, pit])
    return np.array([fed - moved, moved + wash - out[0], out[0] - out[1]]) / surfaces


def shown(levels, inputs=None):
    return levels[:2] / RANGES


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.fixture(scope="module")
def at_rest():
    """Return all levels and both inputs: one flow goes through, and the wash joins it."""
    out = HOLES[0] * np.sqrt(LEVELS[1])
    feed = out - WASH
    inputs = np.array([feed / PUMP, feed / VALVE / np.sqrt(LEVELS[0] + 0.8)])
    return np.array([*LEVELS, (out / HOLES[1]) ** 2]), inputs


def test_it_rests_where_one_flow_goes_through(plant, at_rest):
    levels, inputs = at_rest
    found = plant.point.as_dict()
    assert found["pit.level"] == pytest.approx(levels[2], rel=1e-9)
    assert [found["feed_pump"], found["transfer"]] == pytest.approx(inputs, rel=1e-9)


def test_its_gain_and_time_constants(plant, at_rest):
    gain, times = model(rates, shown, *at_rest)
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain * RANGES[:, None], rel=1e-6, abs=1e-9)
    assert found.time_constants == pytest.approx(times, rel=1e-6)
    # In the end the drum gets what the pump brings, however far the valve is open.
    assert found.static_gain[1, 1] == 0.0


def test_its_loops_run_as_computed(plant, at_rest):
    """The sphere empties by half and the drum fills, both in ramps; then more is washed."""
    levels, inputs = at_rest
    controller = cl.design.simc(plant, pairing={"LT1": "feed_pump", "LT2": "transfer"})
    controller = controller.with_values(
        {"LT1": {"K": "3 %/%", "Ti": "10 min"}, "LT2": {"K": "2 %/%", "Ti": "8 min"}}
    )
    events = [
        cl.ramp("LT1", to="0.5 m", at="20 s", over="10 min"),
        cl.ramp("LT2", to="0.7 m", at="300 s", over="10 min"),
        cl.disturbance("wash", to="1.2 l/s", at="1200 s"),
    ]
    run = cl.simulate(plant, controller, events, duration="40 min")
    loops = PI(3.0, 600.0, PERIOD, inputs[0]), PI(2.0, 480.0, PERIOD, inputs[1])
    found = []
    for sample in range(len(run.time)):
        along = np.clip((PERIOD * sample - np.array([20.0, 300.0])) / 600.0, 0.0, 1.0)
        setpoints = (LEVELS + np.array([-0.4, 0.2]) * along) / RANGES
        moved = [
            loop(setpoint, reading)
            for loop, setpoint, reading in zip(loops, setpoints, shown(levels), strict=True)
        ]
        found.append((*levels, *moved))
        levels = advanced(rates, levels, (moved, WASH + 1e-3 * (sample >= 600)), PERIOD)
    *levels, feed, valve = np.array(found).T
    for vessel, level in zip(("sphere", "drum", "pit"), levels, strict=True):
        assert np.abs(run.values[f"{vessel}.level"] - level).max() < 1e-6, vessel
    assert np.abs(run.values["feed_pump"] - feed).max() < 1e-6
    assert np.abs(run.values["transfer"] - valve).max() < 1e-6
    assert np.ptp(levels[0]) > 0.3 and np.ptp(levels[1]) > 0.15 and np.ptp(levels[2]) > 0.05
