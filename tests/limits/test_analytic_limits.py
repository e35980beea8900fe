"""Limits that have a closed form: a store is filled as fast as it can be, and then stands."""

import numpy as np
import pytest
from refusals import refused

import clepsydra as cl

FILLED = """
name = "filled"
sampling_period = "1 s"
controlled = ["level_1"]
manipulated = ["feed"]

[tanks.tank_1]
{tank}

[flows.feed]
destination = "tank_1"
range = ["0 l/s", "1 l/s"]
nominal = "0 l/s"

[sensors.level_1]
tank = "tank_1"
range = ["0 m", "1 m"]

[operating_point]
level_1 = "0.2 m"
"""
#: What a limit is proved within.
TOLERANCE = 0.005


@pytest.fixture
def filled(tmp_path):
    """Return a store of some shape that a flow of up to 1 l/s fills."""

    def written(tank: str) -> cl.Plant:
        path = tmp_path / "filled.toml"
        path.write_text(FILLED.format(tank=tank), "utf-8")
        return cl.load(path)

    return written


def test_a_tank_is_filled_by_its_full_inflow(filled):
    """A uniform tank of 0.1 m² takes 30 s for 30 cm: a triangle of 0.3 m in 30 s."""
    plant = filled('area = "0.1 m^2"\nheight = "1 m"')
    found = cl.limit(plant, [cl.step("level_1", "+0.3 m", at="5 s")], duration="3 min")
    assert found.index == pytest.approx(30.0 / 2, rel=TOLERANCE)
    feed = found.found[0].best.values["feed"]
    assert np.all(feed[:29] > 0.99e-3) and np.all(feed[31:] < 1e-6)


def test_a_cone_is_filled_in_least_time(filled):
    """V = c h³ grows with q: ∫(h₁ - h)dt = h₁ T - 3c/(4q) (h₁⁴ - h₀⁴), T = c/q (h₁³ - h₀³)."""
    plant = filled('shape = "cone"\nrim_diameter = "0.6 m"\nheight = "1 m"')
    constant, inflow, low, high = np.pi / 12 * 0.6**2, 1e-3, 0.2, 0.6
    time = constant / inflow * (high**3 - low**3)
    area = high * time - 0.75 * constant / inflow * (high**4 - low**4)
    found = cl.limit(plant, [cl.step("level_1", to="0.6 m", at="5 s")], duration="2 min")
    assert found.found[0].accepted
    assert found.index == pytest.approx(area / (high - low), rel=TOLERANCE)


def test_a_narrower_bound_costs_what_it_holds_back(filled):
    """Half the inflow fills the tank in twice the time."""
    plant = filled('area = "0.1 m^2"\nheight = "1 m"')
    step = [cl.step("level_1", "+0.3 m", at="5 s")]
    found = cl.limit(plant, step, duration="3 min", within={"feed": ("0 l/s", "0.5 l/s")})
    assert found.index == pytest.approx(60.0 / 2, rel=TOLERANCE)


def test_a_horizon_that_is_too_short_is_refused(filled):
    plant = filled('area = "0.1 m^2"\nheight = "1 m"')
    step = [cl.step("level_1", "+0.3 m", at="5 s")]
    with refused(place="limit, duration", value="20 s", expected="come to rest", remedy="lengthen"):
        cl.limit(plant, step, duration="25 s")
