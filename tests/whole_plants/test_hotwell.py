"""The hotwell of docs/examples, whose pump at constant speed feeds a level valve and a way back.

All heads stand in metres of water. The pump gives x where H(x) = a − b x² between two points of
its curve, the line back takes G_r √H, and the valve with its pipe G √(H + h − 17 m):

    G √(H(x) + h − 17) + G_r √H(x) = x,    A dh/dt = condensate − G √(H(x) + h − 17)
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from by_hand import PI, advanced, model
from scipy.optimize import brentq

import clepsydra as cl

FILE = Path(__file__).parents[2] / "docs" / "examples" / "hotwell.toml"
HOUR, PERIOD = 3600.0, 5.0
AREA = np.pi * 1.2**2
CURVE = ((0.0, 46.0), (8.0, 44.5), (16.0, 40.0), (24.0, 31.0), (30.0, 21.0))  # [m³/h], [m]
PER_ROOT = np.sqrt(9.81 / 100.0)  # √m of a metre of water at a Kv of 1
LIFT, LAG, LEAST, CONDENSATE = 17.0, 3.0, 6.0, 14.0
RANGE = 3.0  # [m], of the transmitter, 4 to 20 mA
KINDS = ("automatic", "open line")


def head(flow):
    ends = [*pairwise(CURVE)]
    (q1, h1), (q2, h2) = next((each for each in ends if flow <= each[1][0]), ends[-1])
    return h1 - (h1 - h2) * (flow**2 - q1**2) / (q2**2 - q1**2)


def discharge(opening, level, kind):
    """Return what leaves to the deaerator [m³/h]."""
    valve = 25.0 * 40.0 ** (opening - 1.0)
    both = PER_ROOT / np.sqrt(valve**-2 + 30.0**-2)

    def through(flow):
        lifted = head(max(flow, LEAST)) if kind == "automatic" else head(flow)
        return both * np.sqrt(max(lifted + level - LIFT, 0.0))

    def excess(flow):
        back = 2.5 * PER_ROOT * np.sqrt(head(flow)) if kind == "open line" else 0.0
        return through(flow) + back - flow

    return through(brentq(excess, 0.0, 35.0, xtol=1e-14, rtol=1e-14))


def rates(state, inputs, condensate=CONDENSATE, kind=KINDS[0], time=0.0):
    level, opening = state
    out = discharge(opening, level, kind)
    return np.array([(condensate - out) / HOUR / AREA, (inputs[0] - opening) / LAG])


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.fixture
def plant(kind):
    return cl.load(FILE if kind == KINDS[0] else f"{FILE}:open-line")


@pytest.fixture
def opening(kind):
    return brentq(lambda s: discharge(s, 1.5, kind) - CONDENSATE, 0.01, 1.0, xtol=1e-15)


def test_it_rests_where_the_valve_lets_the_condensate_go(plant, opening):
    assert plant.point.as_dict()["LV201.position"] == pytest.approx(opening, rel=1e-9)
    assert plant.point.as_dict()["LV201"] == pytest.approx(4e-3 + 16e-3 * opening, rel=1e-9)


def test_its_gain_and_time_constants(plant, kind, opening):
    gain, times = model(
        lambda state, inputs: rates(state, inputs, kind=kind),
        lambda state, inputs: state[:1] / RANGE, np.array([1.5, opening]), np.array([opening]),
    )  # fmt: skip
    found = cl.analyse(plant)
    assert found.static_gain == pytest.approx(gain, rel=1e-4)
    assert found.time_constants == pytest.approx(times, rel=1e-4)


def test_its_loop_runs_as_computed(plant, kind, opening):
    """A setpoint step, more condensate than the valve can pass for a while, and less."""
    settings = {"LT201": {"K": "20 %/%", "Ti": "10 min"}}
    events = [
        cl.step("LT201", to="70 %", at="50 s"),
        cl.disturbance("condensate", to="24 m^3/h", at="500 s"),
        cl.disturbance("condensate", to="8 m^3/h", at="1000 s"),
    ]
    controller = cl.design.simc(plant).with_values(settings)
    run = cl.simulate(plant, controller, events, duration="1800 s")
    loop = PI(-20.0, 600.0, PERIOD, opening)
    state, found = np.array([1.5, opening]), []
    for sample in range(len(run.time)):
        setpoint = 0.5 + 0.2 * (sample >= 10)
        condensate = CONDENSATE + 10.0 * (sample >= 100) - 16.0 * (sample >= 200)
        moved = loop(setpoint, state[0] / RANGE)
        found.append((*state, moved))
        state = advanced(rates, state, ([moved], condensate, kind), PERIOD)
    level, stem, moved = np.array(found).T
    assert np.abs(run.values["hotwell.level"] - level).max() < 1e-6 * RANGE
    assert np.abs(run.values["LV201.position"] - stem).max() < 1e-6
    assert np.abs(run.values["LV201"] - (4e-3 + 16e-3 * moved)).max() < 1e-6 * 16e-3
    assert moved.min() == 0.0 and moved.max() == 1.0 and np.ptp(level) > 0.3
