"""The surge vessel of docs/examples under PI control, computed a second time without Clepsydra.

Mass balance, valve and pipe in series, stroke and sampled PI stand here in full, and SciPy
integrates them from sample to sample.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import clepsydra as cl

FILE = Path(__file__).parents[1] / "docs" / "examples" / "surge-vessel.toml"
AREA, BOTTOM, SPAN = np.pi * 1.5**2, 0.5, 3.0
HOUR = 3600.0


def flow(level: float, opening: float) -> float:
    """Kv of valve and pipe in series at the head of the level, 6 m of rise and 1.8 bar [m³/s]."""
    valve = 80.0 * 40.0 ** (opening - 1.0)
    together = 1.0 / np.sqrt(valve**-2 + 140.0**-2)
    pressure = 1000.0 * 9.81 * (level - 6.0) + 1.8e5
    return together * np.sqrt(max(pressure, 0.0) / 1e5) / HOUR


@pytest.fixture(scope="module")
def study():
    return cl.study(cl.load(FILE), only="PI, arrest time, tuned")


def test_what_is_tuned_is_damped_and_the_terminal_says_what_the_outflow_does(study):
    tuned = study["PI, arrest time, tuned"]
    # ζ = (k + a)/(2 √(k/Ti)) of PI on a level, with k = K dq/du/(A dy/dh) and a = dq/dh/A.
    values = tuned.controller.values
    gain, time = (values[f"LT301.{key}"] for key in ("proportional_gain", "integral_time"))
    rest = brentq(lambda x: flow(2.0, x) - 60.0 / HOUR, 0.01, 1.0)
    slope = (flow(2.0, rest + 1e-6) - flow(2.0, rest - 1e-6)) / 2e-6
    pace = abs(gain) * slope / (AREA * SPAN)
    own = (flow(2.001, rest) - flow(1.999, rest)) / 0.002 / AREA
    assert (pace + own) / (2.0 * np.sqrt(pace / time)) == pytest.approx(0.7, abs=0.03)
    assert 15.0 < tuned.scores["outflow_overshoot[LT301]"] < 25.0  # 21 % of a linear loop
    assert tuned.scores["outflow_swings[LT301]"] == 1.0
    said = str(study)
    assert "overshoot by 2" in " ".join(said.split()) and "swings" in said


def test_the_run_is_that_of_a_second_computation(study):
    run = study["PI, arrest time, tuned"].run
    values = run.controller.values
    gain, time = (values[f"LT301.{key}"] for key in ("proportional_gain", "integral_time"))
    weight = values["LT301.setpoint_weight"]
    period = 5.0
    samples = round(next(s.stop for s in run.scenario.segments if s.kind == "load") / period)
    feed, setpoint = run.values["feed"], run.values["LT301.setpoint"]
    seen, low, high = run.values["LT301"], 0.004, 0.020
    level, u = 2.0, float(run.values["LV301"][0])
    opening = (u - low) / (high - low)
    integral = u - gain * (weight * setpoint[0] - setpoint[0])
    levels = []
    for k in range(samples):
        levels.append(level)
        y = seen[k]  # with its resolution
        wanted = gain * (weight * setpoint[k] - y) + integral
        integral += period * gain / time * (setpoint[k] - y)
        target = (min(max(wanted, low), high) - low) / (high - low)

        def motion(t, state, target=target, begun=opening, inflow=feed[k]):
            moved = np.clip(target - begun, -t / 15.0, t / 15.0)
            return [(inflow - flow(state[0], begun + moved)) / AREA]

        level = solve_ivp(motion, (0.0, period), [level], rtol=1e-8, atol=1e-10).y[0, -1]
        opening += np.clip(target - opening, -period / 15.0, period / 15.0)
    assert np.max(np.abs(run.values["V301.level"][:samples] - levels)) < 1e-3
