"""Two pumps on a header lift from a well through one valve, whose actuator takes 20 s.

At one head H each gives what its curve has there, x = √((a − H)/b) between two points, and at the
head of its minimum flow anything up to that; the valve takes G √(H + h − 10 m). The actuator goes
at most a twentieth of its stroke a second, the last of the way with 1 s.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model
from scipy.optimize import brentq

import clepsydra as cl

FILE = Path(__file__).with_name("pumping-station.toml")
HOUR, PERIOD = 3600.0, 2.0
#: Points of a curve [m³/h], [m], and the minimum flow.
LARGE = ((0.0, 32.0), (10.0, 30.0), (20.0, 24.0), (30.0, 13.0)), 5.0
SMALL = ((0.0, 29.0), (8.0, 26.0), (16.0, 19.0), (22.0, 10.0)), 3.0
PUMPS = {"like": (LARGE, LARGE), "unlike": (LARGE, SMALL)}
AREA, RANGE, LIFT, LEVEL = 6.0, 4.0, 10.0, 2.0
#: Sewage at rest, when it has nearly stopped, and when it is back [m³/h].
SEWAGE = {"like": (38.0, 3.0, 30.0), "unlike": (30.0, 2.0, 22.0)}


def given(pump, head):
    """Return what one pump gives at a head on the header [m³/h]."""
    points, least = pump
    for (q1, h1), (q2, h2) in pairwise(points):
        b = (h1 - h2) / (q2**2 - q1**2)
        flow = np.sqrt(max(h1 + b * q1**2 - head, 0.0) / b)
        if flow <= q2:
            break
    return flow if flow >= least else 0.0


def lifted(stroke, level, pumps):
    """Return what all give together [m³/h]."""
    if stroke <= 0.0:
        return 0.0
    both = np.sqrt(9.81 / 100.0) / np.sqrt((45.0 * stroke) ** -2 + 80.0**-2)

    def taken(head):
        return both * np.sqrt(max(head + level - LIFT, 0.0))

    def excess(head):
        return sum(given(pump, head) for pump in pumps) - taken(head)

    return taken(brentq(excess, -200.0, 33.0, xtol=1e-13, rtol=1e-14))


def rates(state, inputs, sewage, pumps, time=0.0):
    level, stroke, told = state
    speed = np.clip(inputs[0] - stroke, -1.0 / 20.0, 1.0 / 20.0)
    return np.array(
        [(sewage - lifted(stroke, level, pumps)) / HOUR / AREA, speed, (level - told) / 2.0]
    )


@pytest.fixture(scope="module", params=PUMPS)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def plant(kind):
    return cl.load(FILE if kind == "like" else f"{FILE}:unlike")


@pytest.fixture(scope="module")
def stroke(kind):
    missing = lambda s: lifted(s, LEVEL, PUMPS[kind]) - SEWAGE[kind][0]  # noqa: E731
    return brentq(missing, 0.01, 1.0, xtol=1e-15)


def test_it_rests_where_both_pumps_give_the_inflow(plant, stroke):
    assert plant.point.as_dict()["FV1"] == pytest.approx(stroke, rel=1e-9)


def test_its_gain_and_time_constants(plant, kind, stroke):
    gain, times = model(
        lambda state, inputs: rates(state, inputs, SEWAGE[kind][0], PUMPS[kind]),
        lambda state, inputs: state[2:], np.array([LEVEL, stroke, LEVEL]), np.array([stroke]),
    )  # fmt: skip
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain, rel=1e-5)
    assert found.time_constants == pytest.approx(times, rel=1e-5)


def test_its_loop_runs_as_computed(plant, kind, stroke):
    """Sewage nearly stops, so that both pumps are left of their minimum flow, and comes back."""
    normal, little, back = SEWAGE[kind]
    controller = cl.design.simc(plant).with_values({"LT1": {"K": "25 %/%", "Ti": "3 min"}})
    events = [
        cl.step("LT1", to="1.8 m", at="20 s"),
        cl.disturbance("sewage", to=f"{little} m^3/h", at="400 s"),
        cl.disturbance("sewage", to=f"{back} m^3/h", at="800 s"),
    ]
    run = cl.simulate(plant, controller, events, duration="20 min")
    loop = PI(-25.0, 180.0, PERIOD, stroke)
    state, found = np.array([LEVEL, stroke, LEVEL]), []
    for sample in range(len(run.time)):
        sewage = normal if sample < 200 else little if sample < 400 else back
        moved = loop((LEVEL - 0.2 * (sample >= 10)) / RANGE, state[2] / RANGE)
        found.append((*state, moved))
        state = advanced(rates, state, ([moved], sewage, PUMPS[kind]), PERIOD)
    level, stem, told, moved = np.array(found).T
    assert np.abs(run.values["well.level"] - level).max() < 1e-6 * RANGE
    assert np.abs(run.values["LT1"] - told).max() < 1e-6 * RANGE
    assert np.abs(run.values["FV1.position"] - stem).max() < 1e-6
    assert np.abs(run.values["FV1"] - moved).max() < 1e-6
    assert np.ptp(stem) > 0.4
    assert lifted(stem.min(), LEVEL, PUMPS[kind]) < min(least for _, least in PUMPS[kind])
