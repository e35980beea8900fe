"""PI control against a plain-Python PI, and what it promises in every mode."""

import math
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_function import by_path, function_of

from clepsydra import PidForm, Signal
from clepsydra.controllers.parameters import remembered_parameters
from clepsydra.controllers.pid import multiloop_pid_law

MANUAL, AUTOMATIC, TRACKING = 0, 1, 2
ANTI_WINDUPS = ["back_calculation", "conditional_integration", "clamping", "none"]
LAWS = {
    way: multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup=way))
    for way in ANTI_WINDUPS
}


def parameters(anti_windup, **changed):
    values = {
        "level_1.proportional_gain": 2.0,
        "level_1.integral_time": 10.0,
        "level_1.setpoint_weight": 1.0,
        "pump_1.low_limit": 0.0,
        "pump_1.high_limit": 10.0,
    }
    if anti_windup == "back_calculation":
        values["level_1.tracking_time"] = 5.0
    return values | by_path(LAWS[anti_windup].parameters, changed)


def inputs(**changed):
    values = {
        "level_1.sp": 5.0,
        "level_1.pv": 5.0,
        "level_1.good": 1.0,
        "pump_1.mode": AUTOMATIC,
        "pump_1.manual": 0.0,
        "pump_1.tracking": 0.0,
        "time_step": 1.0,
    }
    return values | by_path(LAWS["none"].inputs, changed)


def one_loop(driven, anti_windup, integral=4.0, **changed):
    law = multiloop_pid_law(["level_1"], ["pump_1"], PidForm(anti_windup=anti_windup))
    values = parameters(anti_windup, **changed)
    state = {"level_1.integral": integral, "pump_1.last_output": integral}
    return driven(law, values, state | remembered_parameters(law, values))


class PlainPi:
    """One loop, written with branches from the description of the law."""

    def __init__(self, anti_windup, values, integral, last_output):
        self.anti_windup, self.values = anti_windup, values
        self.integral, self.last_output = integral, last_output

    def scan(self, setpoint, measurement, sensor, mode, manual, tracking, time_step):
        p = self.values
        known = math.isfinite(setpoint) and math.isfinite(measurement) and sensor
        step_good = math.isfinite(time_step) and time_step > 0
        status = {AUTOMATIC: 1, TRACKING: 2}.get(mode, 0)
        if not sensor:
            status += 16
        numbers = math.isfinite(setpoint) and math.isfinite(measurement)
        wanted = {MANUAL: manual, TRACKING: tracking}.get(
            mode, 0.0 if mode == AUTOMATIC else math.nan
        )
        if not numbers or not math.isfinite(wanted):
            status += 32
        if not step_good:
            status += 64

        integral, proportional = self.integral, math.nan
        if known:
            proportional = p["gain"] * (p["weight"] * setpoint - measurement)
        if mode == AUTOMATIC and known and step_good:
            unlimited = proportional + self.integral
            output = self.limited(unlimited)
            increment = time_step * p["gain"] / p["integral_time"] * (setpoint - measurement)
            if self.anti_windup == "back_calculation":
                share = min(time_step / p["tracking_time"], 1.0)
                integral = self.integral + increment + share * (output - unlimited)
            elif self.anti_windup == "none":
                integral = self.integral + increment
            elif self.anti_windup == "clamping":
                low, high = min(p["low"], self.integral), max(p["high"], self.integral)
                integral = min(max(self.integral + increment, low), high)
            elif not (
                (unlimited > p["high"] and increment > 0)
                or (unlimited < p["low"] and increment < 0)
            ):
                integral = self.integral + increment
        elif mode in (MANUAL, TRACKING) and math.isfinite(wanted):
            output = self.limited(wanted)
            moved = self.integral + output - self.last_output
            integral = output - proportional if known else moved
        else:
            output = self.limited(self.last_output)
        status += 4 * (output <= p["low"]) + 8 * (output >= p["high"])
        self.integral, self.last_output = integral, output
        return output, status

    def limited(self, value):
        return min(max(value, self.values["low"]), self.values["high"])


@pytest.mark.sampled
@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)
def test_agrees_with_a_plain_pi_through_modes_saturation_and_faults(driven, anti_windup):
    random.seed(7)
    loops = [
        {"gain": 3.0, "integral_time": 30.0, "weight": 1.0, "low": 0.0, "high": 10.0},
        {"gain": -1.5, "integral_time": 4.0, "weight": 0.3, "low": -2.0, "high": 6.0},
    ]
    for loop, time in zip(loops, (20.0, 0.7), strict=True):
        loop["tracking_time"] = time  # the second is at times shorter than the time step
    values = {}
    for i, loop in enumerate(loops, start=1):
        values |= {
            f"level_{i}.proportional_gain": loop["gain"],
            f"level_{i}.integral_time": loop["integral_time"],
            f"level_{i}.setpoint_weight": loop["weight"],
            f"pump_{i}.low_limit": loop["low"],
            f"pump_{i}.high_limit": loop["high"],
            f"level_{i}.tracking_time": loop["tracking_time"],
        }
    state = {
        "level_1.integral": 3.0,
        "pump_1.last_output": 3.0,
        "level_2.integral": 1.0,
        "pump_2.last_output": 1.0,
    }
    law = multiloop_pid_law(
        ["level_1", "level_2"], ["pump_1", "pump_2"], PidForm(anti_windup=anti_windup)
    )
    if anti_windup != "back_calculation":
        values = {k: v for k, v in values.items() if not k.endswith("tracking_time")}
    law = driven(law, values, state | remembered_parameters(law, values))
    plain = [
        PlainPi(anti_windup, loop, 3.0 - 2.0 * i, 3.0 - 2.0 * i) for i, loop in enumerate(loops)
    ]
    parts = {"setpoint": "level.sp", "measurement": "level.pv", "sensor": "level.good"}
    parts |= {name: f"pump.{name}" for name in ("mode", "manual", "tracking")}
    seen = set()
    held = {"mode": [1, 1], "setpoint": [5.0, 2.0]}
    for _ in range(2500):
        for i in range(2):
            if random.random() < 0.03:
                held["mode"][i] = random.choice([0, 1, 2, 1, 5])
            if random.random() < 0.05:
                held["setpoint"][i] = random.choice([random.uniform(0, 10)] * 6 + [math.nan])
        broken = random.random() < 0.1
        time_step = (
            random.choice([0.0, -1.0, math.nan, math.inf]) if broken else random.choice([1.0, 0.5])
        )
        given_inputs, expected = {"time_step": time_step}, []
        for i in range(2):
            measurement = random.uniform(0, 10)
            if random.random() < 0.1:
                measurement = random.choice([math.nan, math.inf, -math.inf])
            arguments = {
                "setpoint": held["setpoint"][i],
                "measurement": measurement,
                "sensor": random.random() > 0.05,
                "mode": held["mode"][i],
                "manual": random.choice([random.uniform(-5, 15)] * 9 + [math.nan]),
                "tracking": random.choice([random.uniform(-5, 15)] * 9 + [math.inf]),
            }
            given_inputs |= {
                parts[name].replace(".", f"_{i + 1}."): value for name, value in arguments.items()
            }
            expected.append(plain[i].scan(**arguments, time_step=time_step))
        found = law.scan(**given_inputs)
        for i, (output, status) in enumerate(expected, start=1):
            assert found[f"pump_{i}.out"] == pytest.approx(output, rel=1e-12, abs=1e-12)
            assert found[f"pump_{i}.status"] == status
            integral = plain[i - 1].integral
            assert law.state[f"level_{i}.integral"] == pytest.approx(integral, rel=1e-10, abs=1e-10)
            assert law.state[f"pump_{i}.last_output"] == found[f"pump_{i}.out"]
            seen.add(status)
    # The samples went through automatic and tracking, both limits, and every kind of fault.
    assert {bit for word in seen for bit in (1, 2, 4, 8, 16, 32, 64) if word & bit} == {
        1, 2, 4, 8, 16, 32, 64,
    }  # fmt: skip
    assert len(seen) > 25


@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS)
@pytest.mark.parametrize("mode", [MANUAL, TRACKING])
def test_automatic_continues_where_the_other_mode_left_the_output(driven, anti_windup, mode):
    law = one_loop(driven, anti_windup, level_1_setpoint_weight=0.4)
    for value in (2.0, 9.0, 7.5):
        law.scan(
            **inputs(
                level_1_sp=6.0,
                level_1_pv=4.5,
                pump_1_mode=mode,
                pump_1_manual=value,
                pump_1_tracking=value,
            )
        )
    found = law.scan(**inputs(level_1_sp=6.0, level_1_pv=4.5))
    assert found["pump_1.out"] == pytest.approx(7.5, abs=1e-14)
    following = law.scan(**inputs(level_1_sp=6.0, level_1_pv=4.5))
    # From there the integral goes on at K/Ti times the error; clamping holds it at 11.7, which
    # is beyond the output's limit of 10, and would only let it come back.
    gained = 0.0 if anti_windup == "clamping" else 2.0 / 10.0 * 1.5
    assert following["pump_1.out"] - 7.5 == pytest.approx(gained, abs=1e-14)


def test_by_hand_the_output_moves_while_the_sensor_is_broken_and_automatic_takes_over(driven):
    law = one_loop(driven, "back_calculation", integral=4.0)
    law.scan(**inputs())
    for value in (5.0, 8.0):
        found = law.scan(
            **inputs(pump_1_mode=MANUAL, pump_1_manual=value, level_1_good=0.0, level_1_pv=math.nan)
        )
        assert found["pump_1.out"] == value
        assert found["pump_1.status"] == 16 + 32
    # Repaired and switched in the same sample, with the measurement where it was: no bump.
    assert law.scan(**inputs())["pump_1.out"] == pytest.approx(8.0, abs=1e-14)


@pytest.mark.parametrize(
    "bad",
    [{"level_1.good": 0.0}, {"level_1.pv": math.nan}, {"level_1.sp": math.inf}, {"time_step": 0.0}],
)
def test_a_bad_sensor_holds_the_output_and_freezes_the_integral(driven, bad):
    law = one_loop(driven, "conditional_integration", integral=4.0)
    before = law.scan(**inputs(level_1_pv=4.0))["pump_1.out"]
    integral = law.state["level_1.integral"]
    assert law.scan(**(inputs(level_1_pv=0.0) | bad))["pump_1.out"] == before
    assert law.state["level_1.integral"] == integral


def test_back_calculation_settles_where_the_excess_is_the_error_times_the_gain_ratio(driven):
    # Saturated at a constant error e, v − u tends to K e Tt/Ti with the ratio 1 − Δt/Tt.
    law = one_loop(driven, "back_calculation", integral=30.0)
    error, gain, integral_time, tracking_time = 1.0, 2.0, 10.0, 5.0
    final = 10.0 + gain * error * tracking_time / integral_time - gain * error
    for sample in range(1, 40):
        assert law.scan(**inputs(level_1_pv=4.0))["pump_1.out"] == 10.0
        expected = final + (30.0 - final) * (1.0 - 1.0 / tracking_time) ** sample
        assert law.state["level_1.integral"] == pytest.approx(expected, rel=1e-12)


def test_conditional_integration_freezes_in_saturation_and_leaves_it_when_the_error_turns(driven):
    law = one_loop(driven, "conditional_integration", integral=9.0)
    for _ in range(50):
        law.scan(**inputs(level_1_pv=4.0))
    # v = K e + I = 2 + 9 is beyond the limit at once, so nothing was added in 50 samples.
    assert law.state["level_1.integral"] == 9.0
    found = law.scan(**inputs(level_1_pv=5.5))
    assert found["pump_1.out"] == pytest.approx(9.0 - 2.0 * 0.5, abs=1e-14)


@pytest.mark.parametrize("anti_windup", ANTI_WINDUPS[:3])
def test_recovery_is_sooner_than_without_anti_windup(driven, anti_windup):
    law, samples = one_loop(driven, anti_windup, integral=9.0), 100
    for _ in range(samples):
        law.scan(**inputs(level_1_pv=4.0))
    count = 0
    while law.scan(**inputs(level_1_pv=5.5))["pump_1.out"] >= 10.0:
        count += 1
    # An integral that went on for 100 samples at 0.2 would stand at 29 and come down at 0.1 a
    # sample until I − 1 < 10: 180 samples at the limit.
    assert count <= 2


anything = st.floats()


@pytest.mark.thorough
@settings(max_examples=400, deadline=None)
@given(
    anti_windup=st.sampled_from(ANTI_WINDUPS),
    gain=st.floats(-1e9, 1e9),
    integral_time=st.floats(1e-6, 1e9),
    tracking_time=st.floats(1e-6, 1e9),
    weight=st.floats(0.0, 1.0),
    low=st.floats(-1e9, 1e9),
    width=st.floats(1e-3, 1e9),
    integral=st.floats(-1e300, 1e300),
    scans=st.lists(
        st.tuples(
            anything, anything, st.booleans(), st.integers(-1, 3), anything, anything, anything
        ),
        min_size=1,
        max_size=6,
    ),
)
def test_output_within_limits_and_no_not_a_number_whatever_comes_in(
    anti_windup, gain, integral_time, tracking_time, weight, low, width, integral, scans
):
    law = LAWS[anti_windup]
    values = {
        "level_1.proportional_gain": gain,
        "level_1.integral_time": integral_time,
        "level_1.setpoint_weight": weight,
        "pump_1.low_limit": low,
        "pump_1.high_limit": low + width,
        "level_1.tracking_time": tracking_time,
    }
    state = {"level_1.integral": integral, "pump_1.last_output": low} | remembered_parameters(
        law, values
    )
    for setpoint, measurement, sensor, mode, manual, tracking, time_step in scans:
        given_inputs = {
            "level_1.sp": setpoint,
            "level_1.pv": measurement,
            "level_1.good": float(sensor),
            "pump_1.mode": mode,
            "pump_1.manual": manual,
            "pump_1.tracking": tracking,
            "time_step": time_step,
        }
        next_state, outputs, _ = function_of(law)(
            [state[signal.name] for signal in law.state],
            [given_inputs[signal.name] for signal in law.inputs],
            [values[signal.name] for signal in law.parameters],
        )
        state = dict(zip([signal.name for signal in law.state], next_state, strict=True))
        assert low <= outputs[0] <= low + width
        assert all(math.isfinite(value) and abs(value) <= 1e300 for value in next_state)
        assert outputs[1] in range(128)


def test_parameters_changed_to_nonsense_at_run_time_hold_the_output(driven):
    for nonsense in (
        {"level_1.proportional_gain": math.nan},
        {"level_1.setpoint_weight": math.inf},
    ):
        law = one_loop(driven, "back_calculation", integral=4.0)
        assert law.scan(**inputs(level_1_pv=4.5))["pump_1.out"] == 5.0
        integral = law.state["level_1.integral"]
        law.values |= nonsense
        found = law.scan(**inputs(level_1_pv=4.5))
        assert 0.0 <= found["pump_1.out"] <= 10.0
        assert law.state["level_1.integral"] == integral
    law = one_loop(driven, "conditional_integration", pump_1_high_limit=math.nan)
    assert law.scan(**inputs())["pump_1.out"] == 4.0


def test_signals_take_unit_and_range_from_the_process():
    level = Signal("level_1", "V", low=0.0, high=8.0)
    pump = Signal("pump_1", "A", low=1.0, high=9.0, initial=3.0)
    law = multiloop_pid_law([level], [pump])
    by_name = {signal.name: signal for signal in (*law.inputs, *law.outputs, *law.parameters)}
    assert by_name["level_1.sp"].high == 8.0
    assert by_name["pump_1.out"].low == 1.0
    assert by_name["level_1.proportional_gain"].unit == "A/V"
    assert by_name["pump_1.low_limit"].initial == 1.0
    assert by_name["pump_1.mode"].kind == "integer"
    assert by_name["level_1.good"].kind == "boolean"
