"""Three faults of the PID block that open PLC runtimes ship; none of them is in this one.

That block is XOUT := KP·(ERROR + ∫ERROR/TR + TD·dERROR/dt) with ERROR := PV − SP: its sign is
reversed, an integral time of zero is divided by, and its output has no limits.
"""

import math
from dataclasses import replace

import block_interpreter
import pytest
from block_interpreter import evaluate_block
from pid_rig import HIGH, LOW, forms, name_of, one_loop, settings, winding_forms

from clepsydra import program_of

STEP = 0.5


def divided(a, b):
    if b == 0:
        raise ZeroDivisionError(f"{a} / {b}")
    return a / b


INTEGRATING = [form for form in forms() if form.has_integral]


@pytest.mark.sampled
@pytest.mark.parametrize("gain", [8.0, -8.0], ids=["fills", "empties"])
@pytest.mark.parametrize("form", INTEGRATING, ids=name_of)
def test_the_sign_is_not_reversed_a_tank_comes_to_its_setpoint(form, gain):
    """A tank with a pump that fills or empties it, dh/dt = ±(u − 50)/200: a reversed sign runs
    it full or dry."""
    level, law = 5.0, one_loop(form, settings(form, gain=gain, integral_time=60.0))
    law.give({"time_step": STEP, "level_1.sp": 7.0})
    for _ in range(1500):
        level += math.copysign(STEP, gain) * (law.moved(level_1_pv=level) - 50.0) / 200.0
    assert level == pytest.approx(7.0, abs=1e-5)


ZEROS = (
    {"level_1.integral_time": 0.0},
    {"level_1.integral_time": -0.0, "level_1.derivative_time": 0.0},
    {"level_1.derivative_time": 0.0},
    {"level_1.derivative_filter": 0.0},
    {"level_1.filter_time": 0.0},
    {"level_1.tracking_time": 0.0},
    {"level_1.setpoint_weight": 0.0, "level_1.proportional_gain": 0.0},
    {"level_1.squared_error_scale": 0.0},
    {"level_1.gap": 0.0, "level_1.gap_gain": 0.0},
    {"level_1.setpoint_ramp": 0.0, "pump_1.rate_limit": 0.0},
)


SHAPED = [form for shape in ("gap", "squared") for form in winding_forms(error=shape)]


@pytest.mark.sampled
@pytest.mark.parametrize("form", [*winding_forms(), *SHAPED], ids=name_of)
def test_nothing_is_divided_by_zero_at_an_integral_time_of_zero(form, monkeypatch):
    """The program statement by statement, branches that are not taken included: many a PLC
    stops at a division by zero whose result nothing reads."""
    monkeypatch.setitem(block_interpreter.MEANING, "divide", divided)
    form = replace(form, setpoint_ramp=True)
    law = one_loop(form, settings(form, gain=3.0), rate_limited=True)
    block = program_of(law.law).block
    for zeros in ({}, *ZEROS):
        law.values |= {name: value for name, value in zeros.items() if name in law.values}
        for time_step in (STEP, 0.0):
            law.give({"time_step": time_step, "level_1.pv": 4.0})
            values = [*law.state.values(), *law.inputs.values(), *law.values.values()]
            results = evaluate_block(block, values)
            assert all(map(math.isfinite, results))
            law.scan()
            assert LOW <= results[len(law.state)] <= HIGH
    # The interpreter does stop at one: the equation of that block.
    with pytest.raises(ZeroDivisionError):
        divided(1.0, 0.0)


@pytest.mark.parametrize("form", winding_forms(), ids=name_of)
def test_the_output_has_limits(form):
    for error in (1e3, -1e3, 1e12, -1e12):
        law = one_loop(form, settings(form, gain=3.0), time_step=STEP)
        for _ in range(20):
            output = law.moved(level_1_sp=error)
            assert LOW <= output <= HIGH
        # Increments beyond a limit are lost, so that a velocity form falls back with the kick
        # of a derivative on the error; all others stand at the limit.
        if not (form.algorithm == "velocity" and form.derivative_on == "error"):
            assert output == (HIGH if error > 0 else LOW)
        # Manual and tracking values too.
        for mode in (0, 2):
            found = law.moved(pump_1_mode=mode, pump_1_manual=error, pump_1_tracking=error)
            assert found == (HIGH if error > 0 else LOW)
