"""Variable-structure PID: against itself written once more, in closed form, and without a bump."""

import numpy as np
import pytest
from pid_rig import AUTOMATIC, BUMP, HIGH, LOW, MANUAL, TRACKING, PlainPid, Scans, settings
from refusals import refused

from clepsydra import PidForm
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.variable_structure_pid import (
    variable_structure_form,
    variable_structure_pid_law,
)

FORMS = {
    "PI": PidForm("PI"),
    "PID": PidForm("PID"),
    "PID-on-error": PidForm("PID", derivative_on="error"),
    "parallel": PidForm("PID", "parallel"),
    "series": PidForm("PI", "series"),
}
ALPHA = 0.3


def loop(form, gain=2.0, alpha=ALPHA, rest=5.0, output=50.0, **changed):
    values = settings(form, gain=gain, **changed) | {"level_1.saturation_rate": alpha}
    given = {
        "level_1.sp": rest,
        "level_1.pv": rest,
        "pump_1.tracking": output,
        "pump_1.manual": output,
    }
    return Scans(variable_structure_pid_law(["level_1"], ["pump_1"], form), values, **given)


@pytest.mark.parametrize("gain", [16.0, -16.0])
@pytest.mark.parametrize("name", FORMS)
def test_equals_the_rule_written_once_more(name, gain):
    """η′ = −α (u_n − u_s)/K_I while it saturates and the error pushes on, else η′ = e."""
    form = FORMS[name]
    scans = loop(form, gain=gain)
    plain = PlainPid(form, scans.values, rest=5.0)
    random = np.random.default_rng(4)
    integral, middle, winding, step = 50.0, 0.5 * (LOW + HIGH), 0, 0.5
    coming_back = 0
    for k in range(600):
        if k % 70 == 69:
            # An integral beyond the limits, as a change of them leaves it: it comes back by the
            # error alone where that does not push on.
            integral = random.choice([-60.0, 160.0])
            scans.state["level_1.integral"] = integral
        if k == 0:
            setpoint = measurement = 5.0
        elif k % 40 == 0:
            setpoint = random.uniform(0.0, 20.0)
        measurement += random.normal(scale=0.2) + 0.05 * (setpoint - measurement)
        found = scans.moved(level_1_sp=setpoint, level_1_pv=measurement, time_step=step)
        part, increment = plain.sample(setpoint, measurement, step)
        asked = part + integral
        applied = min(HIGH, max(LOW, asked))
        if asked != applied and increment * (asked - middle) > 0.0:
            integral -= min(ALPHA * step, 1.0) * (asked - applied)
            winding += 1
        else:
            coming_back += int(asked != applied)
            integral += increment
        assert found == pytest.approx(applied, abs=1e-9)
        assert scans.state["level_1.integral"] == pytest.approx(integral, abs=1e-9)
    assert 20 < winding < 580
    assert coming_back > 5


def test_the_excess_dies_away_with_alpha():
    """With a steady error u_n − u_s shrinks by 1 − α Δt a sample: e^(−α t) for short samples."""
    step, alpha = 1e-3, 0.8
    scans = loop(PidForm("PI"), gain=30.0, alpha=alpha)
    excess = []
    for _ in range(3001):
        scans.scan(level_1_sp=8.0, time_step=step)
        # P part 30 · 3 above the integral that the next sample starts with.
        excess.append(90.0 + scans.state["level_1.integral"] - HIGH)
    ratio = np.array(excess[1:]) / np.array(excess[:-1])
    assert ratio == pytest.approx(1.0 - alpha * step, abs=1e-9)
    time = step * 3000
    assert excess[-1] / excess[0] == pytest.approx(np.exp(-alpha * time), rel=1e-3)


def test_with_alpha_zero_it_is_conditional_integration_away_from_the_middle():
    form = PidForm("PI", anti_windup="conditional_integration")
    values = settings(form, gain=4.0)
    given = {"level_1.sp": 5.0, "level_1.pv": 5.0, "pump_1.tracking": 50.0, "pump_1.manual": 50.0}
    other = Scans(multiloop_pid_law(["level_1"], ["pump_1"], form), values, **given)
    scans = loop(PidForm("PI"), gain=4.0, alpha=0.0)
    random = np.random.default_rng(9)
    saturated = 0
    for _ in range(400):
        now = {"level_1.sp": random.uniform(0, 40), "level_1.pv": 5.0, "time_step": 1.0}
        pair = scans.moved(**now), other.moved(**now)
        assert pair[0] == pair[1]
        saturated += pair[0] in (LOW, HIGH)
    assert saturated > 100


def test_without_saturation_it_is_the_plain_controller_bit_for_bit():
    form = PidForm("PID", anti_windup="none")
    values = settings(form, gain=1.5)
    given = {"level_1.sp": 5.0, "level_1.pv": 5.0, "pump_1.tracking": 50.0, "pump_1.manual": 50.0}
    plain = Scans(multiloop_pid_law(["level_1"], ["pump_1"], form), values, **given)
    scans = loop(form, gain=1.5)
    random = np.random.default_rng(2)
    for _ in range(300):
        now = {"level_1.pv": 5.0 + random.normal(scale=0.3), "time_step": 0.25}
        moved = scans.moved(**now)
        assert moved == plain.moved(**now)
        assert LOW < moved < HIGH


def test_a_long_time_step_takes_back_the_excess_and_no_more():
    scans = loop(PidForm("PI"), gain=30.0, alpha=5.0)
    scans.scan(level_1_sp=8.0, time_step=1.0)
    assert 90.0 + scans.state["level_1.integral"] == pytest.approx(HIGH, abs=1e-12)


@pytest.mark.parametrize("name", FORMS)
def test_modes_and_gains_change_without_a_bump(name):
    """Through manual and tracking, with another gain each time that automatic takes over."""
    scans = loop(FORMS[name])
    random = np.random.default_rng(7)
    level, last = 5.0, 50.0
    for k in range(200):
        mode = (AUTOMATIC, MANUAL, AUTOMATIC, TRACKING)[k // 10 % 4]
        if k % 10 == 0:
            # Measurement and time stand still: the mode and the gain alone change.
            scans.set(level_1_proportional_gain=random.uniform(1.0, 4.0))
            found = scans.moved(
                pump_1_mode=mode, pump_1_manual=last, pump_1_tracking=last, time_step=1e-12
            )
            assert found == pytest.approx(last, abs=BUMP)
        level += random.normal(scale=0.05)
        by_hand = random.uniform(30.0, 70.0)
        last = scans.moved(
            pump_1_mode=mode,
            level_1_pv=level,
            pump_1_manual=by_hand,
            pump_1_tracking=by_hand,
            time_step=0.1,
        )


def test_taking_over_goes_on_from_where_the_output_stands():
    scans = loop(PidForm("PI"))
    scans.moved(pump_1_mode=MANUAL, pump_1_manual=37.0, time_step=1.0)
    moved = scans.moved(pump_1_mode=AUTOMATIC, time_step=1.0)
    assert moved == pytest.approx(37.0, abs=BUMP)


@pytest.mark.parametrize("fault", [{"level_1.good": 0.0}, {"level_1.pv": np.nan}])
def test_a_fault_holds_output_and_integral(fault):
    scans = loop(PidForm("PI"))
    before = scans.moved(level_1_sp=9.0, time_step=1.0)
    kept = dict(scans.state)
    assert scans.moved(**fault, time_step=1.0) == before
    assert scans.state["level_1.integral"] == kept["level_1.integral"]


@pytest.mark.parametrize("form", [PidForm("P"), PidForm("PD"), PidForm("PI", "velocity")])
def test_a_form_without_an_integral_is_refused(form):
    with refused(expected="integral action"):
        variable_structure_form(form)
