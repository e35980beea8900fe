"""The funnel of docs/examples, filled from 5 % to 90 % under PI control: by hand as well."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import clepsydra as cl

FILE = Path(__file__).parents[2] / "docs" / "examples" / "cone-from-5-to-90-percent.toml"
#: Of the controller: %/% and s. Of the plant: cm²/s² and cm³/(s %). Of the file: samples of 2 s.
GAIN, TIME, PERIOD = 2.0, 60.0, 2.0
G, HOLE, PUMP = 981.0, 0.5, 2.0


def by_hand(samples, level, output):
    """Level [% of 40 cm] and pump [%] at every sample, from where they stand without a bump.

    Radius over level is a half, so that V = π h³/12 and dh/dt = (2 u - a √(2 g h)) / (π h²/4).
    """

    def rate(_, h, pump):
        return (PUMP * pump - HOLE * np.sqrt(2 * G * h)) / (np.pi * h**2 / 4)

    height, integral = 0.4 * level, output - GAIN * (90.0 - level)
    levels, pumps = [], []
    for _ in range(samples):
        error = 90.0 - height / 0.4
        asked = GAIN * error + integral
        assert 0.0 <= asked <= 100.0  # no limit, so that no anti-windup acts
        levels.append(height / 0.4)
        pumps.append(asked)
        integral += GAIN / TIME * PERIOD * error
        found = solve_ivp(rate, (0.0, PERIOD), [height], args=(asked,), rtol=1e-11, atol=1e-12)
        height = float(found.y[0, -1])
    return np.array(levels), np.array(pumps)


@pytest.fixture(scope="module")
def plant():
    return cl.load(FILE)


@pytest.mark.parametrize("solver", ["kernel", "reference"])
def test_it_goes_from_5_to_90_percent_as_computed_by_hand(plant, solver):
    pi = cl.design.simc(plant).with_values({"level": {"K": GAIN, "Ti": f"{TIME} s"}})
    run = cl.simulate(
        plant,
        pi,
        [cl.step("level", to="90 %", at=0)],
        duration="30 min",
        state={"funnel.level": "5 %", "pump": "20 %"},
        solver=solver,
    )
    level, pump = by_hand(900, 5.0, 20.0)
    assert 100.0 * run.values["level"] == pytest.approx(level, abs=2e-4)
    assert 100.0 * run.values["pump"] == pytest.approx(pump, abs=2e-4)
    assert level[-1] == pytest.approx(90.0, abs=0.01) and level.max() > 93.0


def test_the_linear_model_is_a_tank_324_times_as_wide_at_the_top(plant):
    """The rate of the level per pump goes with one over the square of the level."""
    rates = []
    for percent in (5, 90):
        there = plant.at(outputs={"level": f"{percent} %"})
        rates.append(float(there.linear.B[0, 0]))
    assert rates[0] / rates[1] == pytest.approx((90 / 5) ** 2, rel=1e-6)
