"""Feedback linearisation: against its equations in NumPy, in every mode, at faults and limits."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from refusals import refused
from scan_rig import ScannedLaw, at_rest

import clepsydra as cl
from clepsydra.controllers.virtual_input import ANTI_WINDUPS
from clepsydra.linear.linearise import Derivatives

FULL = cl.load(Path(__file__).with_name("full-effects.toml"))
VALVE = cl.load(Path(__file__).with_name("draining-valve.toml"))


class Settings(NamedTuple):
    gain: float
    integral_gain: float
    setpoint_weight: float


SETTINGS = (Settings(0.08, 0.002, 1.0), Settings(0.05, 0.001, 0.6))
RATES = (0.2, 0.3)
#: Of a range of 10 V.
BUMP = 1e-9 * 10.0
BY_HAND = ("manual", "tracking")


@cache
def full(anti_windup="variable_structure", alpha_on="virtual"):
    controller = cl.design.feedback_linearisation(
        FULL, closed_loop_time_constant=20.0, anti_windup=anti_windup, alpha_on=alpha_on
    )
    values, state = dict(controller.values), dict(controller.initial_state)
    for j, (settings, rate) in enumerate(zip(SETTINGS, RATES, strict=True), start=1):
        gain, integral_gain, weight = settings
        chosen = {
            "virtual_gain": gain,
            "virtual_integral_gain": integral_gain,
            "setpoint_weight": weight,
            "saturation_rate": rate,
            "saturation_feedback": rate,
            "tracking_time": 1.0 / rate,
        }
        y = f"level_{j}"
        named = {f"{y}.{n}": v for n, v in chosen.items()}
        values |= {n: v for n, v in named.items() if n in values}
        state |= {f"{y}.last_virtual_gain": gain, f"{y}.last_setpoint_weight": weight}
        state[f"{y}.virtual_integral"] = gain * (1.0 - weight) * FULL.point.as_dict()[y]
    return replace(controller, values=values, initial_state=state)


class Rig(ScannedLaw):
    """In automatic at rest unless told otherwise; a scan returns what moves the process."""

    def __init__(self, controller):
        super().__init__(controller, 1.0, **at_rest(controller, controller.plant))

    def scan(self, **inputs):
        outputs = super().scan(**inputs)
        return np.array([outputs[f"{name}.out"] for name in self.controller.manipulated])


@cache
def derivatives():
    return Derivatives(FULL.process)


def linear_parts(levels):
    """L and E of the two tanks in volts, from the exact derivatives of the process."""
    still = derivatives().at(np.array(levels) / 40.0, np.zeros(2), np.zeros(0))
    C = still.measured_by_state
    return C @ still.rates, C @ still.rates_by_input


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("anti_windup", "alpha_on"),
    [*((way, "virtual") for way in ANTI_WINDUPS), ("variable_structure", "input")],
)
def test_equals_the_equations_in_numpy(anti_windup, alpha_on):
    controller = full(anti_windup, alpha_on)
    rig = Rig(controller)
    random = np.random.default_rng(12)
    gain, integral_gain, weight = (np.array(c) for c in zip(*SETTINGS, strict=True))
    y = np.array([rig.inputs["level_1.pv"], rig.inputs["level_2.pv"]])
    integral = gain * (1.0 - weight) * y
    rates, step, cut = np.array(RATES), 0.5, 0
    for k in range(500):
        if k % 60 == 0:
            r = random.uniform(1.0, 11.0, 2)
        y = np.clip(y + random.normal(scale=0.15, size=2) + 0.06 * (r - y), 0.2, 11.8)
        u = rig.scan(
            level_1_sp=r[0], level_2_sp=r[1], level_1_pv=y[0], level_2_pv=y[1],
            time_step=step,
        )  # fmt: skip
        L, E = linear_parts(y)
        asked = gain * (weight * r - y) + integral
        wanted = np.linalg.solve(E, asked - L)
        applied = np.clip(wanted, 0.0, 10.0)
        assert u == pytest.approx(applied, abs=1e-9)
        reached = asked if np.all(wanted == applied) else L + E @ applied
        cut += int(reached is not asked)
        increment = step * integral_gain * (r - y)
        middle = L + E @ np.array([5.0, 5.0])
        excess = asked - reached
        winds = (excess != 0.0) & (increment * (asked - middle) > 0.0)
        if anti_windup == "none":
            integral = integral + increment
        elif anti_windup == "conditional_integration":
            integral = np.where(excess * increment > 0.0, integral, integral + increment)
        elif anti_windup == "back_calculation":
            integral = integral + increment - np.minimum(step * rates, 1.0) * excess
        elif anti_windup == "clamping":
            ends = np.array(
                [[L[j] + E[j] @ applied + E[j, j] * (end - applied[j]) for end in (0.0, 10.0)]
                 for j in (0, 1)]
            )  # fmt: skip
            low, high = np.minimum(ends.min(1), integral), np.maximum(ends.max(1), integral)
            integral = np.clip(integral + increment, low, high)
        elif alpha_on == "virtual":
            back = np.minimum(step * rates, 1.0) * excess
            integral = np.where(winds, integral - back, integral + increment)
        else:
            back = np.minimum(np.abs(rates * step * (wanted - applied)), np.abs(excess))
            integral = np.where(winds, integral - np.sign(excess) * back, integral + increment)
        found = [rig.state[f"level_{j}.virtual_integral"] for j in (1, 2)]
        assert found == pytest.approx(integral, abs=1e-9)
    assert 30 < cut < 470


def test_automatic_takes_over_without_a_bump_whatever_was_before():
    rig = Rig(full())
    random = np.random.default_rng(5)
    last = rig.scan()
    for k in range(300):
        modes = [float(random.choice([0.0, 1.0, 2.0, 3.0])) for _ in range(2)]
        if k % 5 == 0:
            # Levels and setpoints stand, and no time passes: the modes alone change.
            last = rig.scan(time_step=1e-12)
            hands = {
                f"pump_{i + 1}_{what}": last[i] for i in range(2) for what in ("manual", "tracking")
            }
            found = rig.scan(pump_1_mode=modes[0], pump_2_mode=modes[1], time_step=1e-12, **hands)
            assert found == pytest.approx(last, abs=BUMP)
        by_hand = {
            f"pump_{i}_{what}": random.uniform(2.0, 8.0)
            for i in (1, 2)
            for what in ("manual", "tracking")
        }
        last = rig.scan(
            level_1_pv=random.uniform(4.0, 8.0), level_2_pv=random.uniform(4.0, 8.0),
            level_1_sp=random.uniform(4.0, 8.0), time_step=1.0, **by_hand,
        )  # fmt: skip


def test_gains_change_without_a_bump():
    rig = Rig(full("none"))
    rig.scan(level_1_sp=6.0, level_1_pv=5.0, level_2_pv=6.5, time_step=1.0)
    last = rig.scan(time_step=1e-12)
    for name, factor in (("level_1.virtual_gain", 1.7), ("level_2.setpoint_weight", 0.5)):
        rig.values[name] *= factor
        assert rig.scan(time_step=1e-12) == pytest.approx(last, abs=BUMP)


def test_a_pump_by_hand_stands_and_the_other_output_is_still_exact():
    """E₂₁ u₁ + E₂₂ u₂ + L₂ = ν₂ with u₁ given by the operator."""
    rig = Rig(full("none"))
    rig.scan(pump_1_mode=0.0, pump_1_manual=6.3, time_step=1.0)
    before = rig.state["level_2.virtual_integral"]
    y = np.array([5.0, 6.0])
    u = rig.scan(level_1_pv=y[0], level_2_pv=y[1], level_2_sp=6.4)
    L, E = linear_parts(y)
    asked = SETTINGS[1].gain * (SETTINGS[1].setpoint_weight * 6.4 - y[1]) + before
    assert u[0] == 6.3
    assert 0.0 < u[1] < 10.0
    assert L[1] + E[1] @ u == pytest.approx(asked, abs=1e-12)


@pytest.mark.parametrize(
    "fault",
    [{"level_2.good": 0.0}, {"level_1.pv": np.nan}, {"level_1.sp": np.inf}, {"time_step": 0.0},
     {"time_step": np.nan}],
)  # fmt: skip
def test_a_fault_holds_both_pumps_and_the_way_back_has_no_bump(fault):
    rig = Rig(full())
    last = rig.scan(level_1_sp=7.0, level_2_pv=6.0, time_step=1.0)
    sound = dict(rig.inputs)
    assert rig.scan(**fault) == pytest.approx(last, abs=0.0)
    assert np.all(np.isfinite(list(rig.state.values())))
    assert rig.scan(**(sound | {"time_step": 1e-12})) == pytest.approx(last, abs=BUMP)


def test_an_empty_tank_divides_by_nothing_and_shuts_the_valve():
    """E = −k √h / A vanishes with the level: the law asks for its limit, in the right sense."""
    empty = Derivatives(VALVE.process).at(np.zeros(1), np.zeros(1), VALVE.point.disturbances)
    assert empty.rates_by_input[0, 0] == 0.0
    rig = Rig(cl.design.feedback_linearisation(VALVE))
    rig.scan(time_step=1.0)
    with np.errstate(all="raise"):
        shut = rig.scan(level_pv=0.0)
        again = rig.scan(level_pv=0.0)
    assert shut == again == [0.0]
    assert np.all(np.isfinite(list(rig.state.values())))
    # Full, it opens.
    assert rig.scan(level_pv=1.99) == [1.0]


def test_no_parameter_of_the_model_can_be_set_to_zero():
    controller = full()
    with refused(place="model.tank_1.area"):
        replace(controller, values=controller.values | {"model.tank_1.area": 0.0})


def test_a_state_that_nobody_measures_is_estimated():
    """The level alone is measured; the speeds of both pumps follow their inputs with a lag.

    The standby pump stands still at the operating point. It acts on the level elsewhere, so that
    it is estimated too, though nothing that the sensor shows corrects it.
    """
    controller = cl.design.feedback_linearisation(cl.load("wet-well"))
    assert controller.measurements == ("level",)
    names = [signal.name for signal in controller.law.state]
    estimated = ["well.level", "duty.actual", "standby.actual"]
    assert [n for n in names if n.endswith(".estimate")] == [f"{n}.estimate" for n in estimated]
    corrected = {name for name in controller.values if ".correction." in name}
    assert corrected == {f"{name}.correction.level" for name in estimated[:2]}


@pytest.mark.parametrize("wrong", [{"anti_windup": "off"}, {"alpha_on": "volts"}])
def test_unknown_names_are_refused(wrong):
    with refused(remedy="correct the name"):
        cl.design.feedback_linearisation(cl.load("quadruple-tank"), **wrong)
