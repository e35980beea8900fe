"""The LQI law against matrices, and how a fault or a mode acts on its outputs."""

import math

import numpy as np
import pytest
from refusals import refused

from clepsydra.base.signal import path
from clepsydra.controllers.linear_quadratic_integral import lqi_law

rng = np.random.default_rng(3)
FEEDBACK, INTEGRAL = rng.normal(size=(2, 3)), 0.1 * rng.normal(size=(2, 2))
REFERENCE, BIAS = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0])
LEVELS, PUMPS = ["level_1", "level_2", "level_3"], ["pump_1", "pump_2"]
CONTROLLED = ["level_3", "level_1"]


def values(anti_windup, low=0.0, high=10.0):
    numbers = {}
    for i in range(2):
        numbers |= {f"pump_{i + 1}.feedback.level_{j + 1}": FEEDBACK[i, j] for j in range(3)}
        numbers |= {
            f"pump_{i + 1}.integral_gain.level_{y}": INTEGRAL[i, j] for j, y in enumerate((3, 1))
        }
        numbers |= {f"pump_{i + 1}.bias": BIAS[i]}
        numbers |= {f"pump_{i + 1}.low_limit": low, f"pump_{i + 1}.high_limit": high}
        if anti_windup == "back_calculation":
            numbers[f"pump_{i + 1}.tracking_time"] = 4.0
    return numbers | {f"level_{j + 1}.reference": REFERENCE[j] for j in range(3)}


def inputs(measurements, setpoints, **changed):
    numbers = {"time_step": 0.5}
    for j in range(3):
        numbers |= {f"level_{j + 1}.pv": measurements[j], f"level_{j + 1}.good": 1.0}
    numbers |= {path(y, "sp"): r for y, r in zip(CONTROLLED, setpoints, strict=True)}
    for i in (1, 2):
        numbers |= {f"pump_{i}.mode": 1, f"pump_{i}.manual": 0.0, f"pump_{i}.tracking": 0.0}
    return numbers | changed


REST = {
    "pump_1.integral": 0.0,
    "pump_2.integral": 0.0,
    "pump_1.last_output": 4.0,
    "pump_2.last_output": 5.0,
}


@pytest.mark.parametrize("anti_windup", ["back_calculation", "conditional_integration"])
def test_equals_the_matrix_equations(driven, anti_windup):
    law = driven(lqi_law(LEVELS, PUMPS, CONTROLLED, anti_windup), values(anti_windup), REST)
    integral, saturated = np.zeros(2), 0
    for _ in range(300):
        y, r = REFERENCE + rng.normal(size=3) * 3.0, rng.normal(size=2) + [3.0, 1.0]
        unlimited = BIAS - FEEDBACK @ (y - REFERENCE) + integral
        output = np.clip(unlimited, 0.0, 10.0)
        increment = 0.5 * INTEGRAL @ (r - y[[2, 0]])
        if anti_windup == "back_calculation":
            integral = integral + increment + 0.5 / 4.0 * (output - unlimited)
        else:
            stops = ((unlimited > 10) & (increment > 0)) | ((unlimited < 0) & (increment < 0))
            integral = integral + np.where(stops, 0.0, increment)
        found = law.scan(**inputs(y, r))
        assert [found["pump_1.out"], found["pump_2.out"]] == pytest.approx(output, abs=1e-12)
        assert [law.state["pump_1.integral"], law.state["pump_2.integral"]] == pytest.approx(
            integral, abs=1e-11
        )
        saturated += int(np.any(output != unlimited))
    assert saturated > 20


def test_at_the_operating_point_it_stands_still(driven):
    law = driven(lqi_law(LEVELS, PUMPS, CONTROLLED), values("back_calculation"), REST)
    found = law.scan(**inputs(REFERENCE, REFERENCE[[2, 0]]))
    assert (found["pump_1.out"], found["pump_2.out"]) == (4.0, 5.0)
    assert law.state == REST


def test_a_fault_of_any_sensor_holds_the_automatic_output_only(driven):
    law = driven(lqi_law(LEVELS, PUMPS, CONTROLLED), values("back_calculation"), REST)
    y = REFERENCE + [0.0, math.nan, 0.0]
    found = law.scan(**inputs(y, [0.0, 0.0], pump_2_mode=0, pump_2_manual=7.0, level_2_good=0.0))
    assert (found["pump_1.out"], found["pump_2.out"]) == (4.0, 7.0)
    assert (found["pump_1.status"], found["pump_2.status"]) == (1 + 16 + 32, 16 + 32)
    assert law.state["pump_1.integral"] == 0.0
    # With the sensor back at its place the second output continues from 7.
    found = law.scan(**inputs(REFERENCE, REFERENCE[[2, 0]]))
    assert found["pump_2.out"] == pytest.approx(7.0, abs=1e-14)


def test_one_output_by_hand_returns_without_a_bump(driven):
    law = driven(lqi_law(LEVELS, PUMPS, CONTROLLED), values("back_calculation"), REST)
    y, r = REFERENCE + [0.3, -0.2, 0.4], [3.1, 1.2]
    law.scan(**inputs(y, r, pump_1_mode=2, pump_1_tracking=8.5))
    assert law.scan(**inputs(y, r))["pump_1.out"] == pytest.approx(8.5, abs=1e-14)


def test_infinities_of_both_signs_hold_the_output(driven):
    law = driven(
        lqi_law(LEVELS, PUMPS, CONTROLLED, "conditional_integration"),
        values("conditional_integration"),
        REST,
    )
    law.values |= {"pump_1.feedback.level_1": 1e9, "pump_1.feedback.level_2": -1e9}
    # 1e9 · 1e300 overflows with both signs: their sum is not a number.
    found = law.scan(**inputs([1e300, 1e300, 3.0], [3.0, 1.0]))
    assert found["pump_1.out"] == 4.0
    assert all(math.isfinite(value) for value in law.state.values())


def test_clamping_is_refused_since_the_integral_is_not_the_whole_output():
    with refused(expected="conditional_integration"):
        lqi_law(["level"], ["pump"], ["level"], "clamping")


@pytest.mark.parametrize("anti_windup", ["none", "conditional_integration"])
def test_input_constrained_lqi_does_not_wind_up(driven, anti_windup):
    """Setpoint 10, y⁺ = y + 0.1 (u − 4), u ≤ 9, F = 2, G = 0.2, u° = 4, time step 1 s.

    In the first samples v = 4 − 2 y + I is below the limit, and all laws are the same. From the
    fifth on the unconstrained integral runs away; the constrained one waits for the level.
    """
    numbers = {
        "level_1.reference": 0.0, "pump_1.feedback.level_1": 2.0,
        "pump_1.integral_gain.level_1": 0.2, "pump_1.bias": 4.0,
        "pump_1.low_limit": 0.0, "pump_1.high_limit": 9.0,
    }  # fmt: skip
    rest = {"pump_1.integral": 0.0, "pump_1.last_output": 4.0}
    law = driven(lqi_law(LEVELS[:1], PUMPS[:1], LEVELS[:1], anti_windup), numbers, rest)
    y, integrals = 0.0, []
    for _ in range(12):
        found = law.scan(
            level_1_sp=10.0, level_1_pv=y, level_1_good=1.0, pump_1_mode=1,
            pump_1_manual=0.0, pump_1_tracking=0.0, time_step=1.0,
        )  # fmt: skip
        y += 0.1 * (found["pump_1.out"] - 4.0)
        integrals.append(law.state["pump_1.integral"])
    # By hand: v = 4, 6, 7.6, 8.84, 9.732 (limited), …
    #          y = 0, 0, 0.2, 0.56, 1.044, 1.544, …
    #          I = 2, 4, 5.96, 7.848 after four samples.
    assert integrals[:4] == pytest.approx([2.0, 4.0, 5.96, 7.848], abs=1e-12)
    if anti_windup == "none":
        assert integrals[4] == pytest.approx(7.848 + 0.2 * (10 - 1.044), abs=1e-12)
        assert integrals[-1] > 15.0
    else:
        # v = 4 − 2·1.044 + 7.848 = 9.76 > 9: nothing is added until the level has risen to
        # where 11.848 − 2 y ≤ 9, y ≥ 1.424, which is so in the sixth sample, at y = 1.544.
        assert integrals[4] == pytest.approx(7.848, abs=1e-12)
        assert integrals[5] == pytest.approx(7.848 + 0.2 * (10 - 1.544), abs=1e-12)
        # Never more above what the limit can give than one sample of integration.
        assert max(integrals) < 9.0 - 4.0 + 2.0 * y + 2.0
