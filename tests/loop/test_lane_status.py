"""Each status of a scenario begins at the number that it is said to begin at.

A tank that drains in proportion to its level, dh/dt = λ (rest - h): a step of z = λ Δt of the
Runge-Kutta method multiplies h - rest by exactly 1 - z + z²/2 - z³/6 + z⁴/24.
"""

import numpy as np
import pytest

from clepsydra import Kernel
from clepsydra.loop.lane_status import LaneStatus, lane_status
from clepsydra.loop.motion_block import MotionBlock, motion_at_rest
from clepsydra.loop.process_period import process_period

Z = 0.5
LEFT = 1 - Z + Z**2 / 2 - Z**3 / 6 + Z**4 / 24
NEAR = 1e-9
#: λ = 0.05 1/s with a step of 10 s; the feed of 0.001 m³/s brings it to rest at 1 m.
TANK = """
controlled = ["level"]
manipulated = ["feed"]
[reservoirs.basin]
[tanks.tank]
area = "0.02 m^2"
height = "1 m"
[linear_outlets.tube]
source = "tank"
destination = "basin"
coefficient = "0.001 m^2/s"
[flows.feed]
destination = "tank"
range = ["0 l/s", "2 l/s"]
nominal = "0.5 l/s"
[sensors.level]
tank = "tank"
range = ["0 cm", "100 cm"]
"""


@pytest.fixture
def status(start):
    """Return a function: levels at first [m], resting level [m] → status after one step."""

    def run(levels, rest):
        point = start(TANK, 10, tank__level=0.5)
        motion = MotionBlock(point.process.motion, 10.0, 1, watched=point.process)
        kernel = Kernel(process_period(point.process, motion, (), shown="start"))
        state = motion_at_rest(point) | {"tank.level": np.asarray(levels, dtype=float)}
        feed = {signal.name: 0.0 for signal in (*point.process.inputs, *point.process.disturbances)}
        result = kernel.run(1, inputs=feed | {"feed": 1e-3 * rest}, state=state)
        return [LaneStatus(int(each)) for each in lane_status(result, point.process)]

    return run


def test_a_tank_counts_as_emptied_at_a_thousandth_of_its_height(status):
    ends = np.array([1e-3 * (1 + NEAR), 1e-3 * (1 - NEAR), 0.0])
    found = status(ends / LEFT, rest=0.0)
    assert found == [LaneStatus(0), LaneStatus.EMPTIED, LaneStatus.EMPTIED]


def test_a_tank_spills_above_its_rim(status):
    ends = np.array([1 - NEAR, 1 + NEAR])
    assert status(1.2 + (ends - 1.2) / LEFT, rest=1.2) == [LaneStatus(0), LaneStatus.SPILLING]


def test_a_step_is_too_long_where_a_thousandth_of_the_range_may_be_wrong(status):
    """Of a linear rate h/12 |k₁ - 2 k₃ + k₄| is z⁴/48 of the way to rest."""
    way = 1e-3 * 48 / Z**4  # 0.768 m
    below = np.array([way * (1 - NEAR), way * (1 + NEAR)])
    for levels, rest in ((below, 0.0), (0.9 - below, 0.9)):
        assert status(levels, rest) == [LaneStatus(0), LaneStatus.STEP_TOO_LONG]


def test_what_is_beyond_all_numbers_is_none(status):
    """A state may grow to 1e300, up or down; infinity and what is no number are none."""
    with np.errstate(over="ignore", invalid="ignore"):
        found = status(np.array([0.99e300, 1.01e300, np.nan, np.inf]) / LEFT, rest=0.0)
    assert [LaneStatus.NOT_A_NUMBER in each for each in found] == [False, True, True, True]
