"""Three vendors' programs, sample by sample from their documents, against the controller's law."""

import numpy as np
import pytest
from tunings import BLOCKS, LEVEL, PUMP, tuning

from clepsydra import PidForm
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.deploy.vendor_tuning.filling import filled

PERIOD, SAMPLES, REST, OUTPUT = 0.5, 400, 2.5, 5.0


def records():
    """A setpoint [m] that steps and a measurement [m] that wanders."""
    random = np.random.default_rng(3)
    setpoint = np.where(np.arange(SAMPLES) < 50, REST, REST + 0.2)
    measurement = REST + np.cumsum(random.normal(scale=0.002, size=SAMPLES))
    measurement[0] = REST
    return setpoint, measurement


def own_output(case):
    """The controller's law on the records [V], from rest and far from its limits."""
    numbers = case.settings
    law = multiloop_pid_law([LEVEL], [PUMP], case.form)
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    values |= {
        "level.proportional_gain": numbers.gain,
        "level.integral_time": numbers.integral_time,
        "level.setpoint_weight": numbers.setpoint_weight,
        "pump.low_limit": -1e6,
        "pump.high_limit": 1e6,
    }
    if case.form.has_derivative:
        values["level.derivative_time"] = numbers.derivative_time
        values["level.derivative_filter"] = numbers.derivative_time / numbers.filter_time
    inputs = {signal.name: signal.initial for signal in law.inputs}
    inputs |= {"level.sp": REST, "level.pv": REST, "pump.tracking": OUTPUT}
    state = list(state_at_rest(law, values, inputs).values())
    found = []
    for r, y in zip(*records(), strict=True):
        inputs |= {"level.sp": r, "level.pv": y, "time_step": PERIOD}
        state, outputs, _ = law.function(state, list(inputs.values()), list(values.values()))
        found.append(float(outputs[0]))
    return np.array(found)


def entered(key, case):
    found = filled(BLOCKS[key], case)
    return {setting.name: setting.value for setting in found.settings}, dict(found.choices)


def iec_61131_3(case):
    """PID of annex F, with its INTEGRAL and its DERIVATIVE over four samples."""
    v, _ = entered("iec-61131-3-pid", case)
    centimetres = 100.0 * np.array(records())
    setpoint, measurement = centimetres
    total, last = v["TR"] * OUTPUT / v["KP"], [0.0, 0.0, 0.0]
    found = []
    for sp, pv in zip(setpoint, measurement, strict=True):
        error = pv - sp
        total += error * PERIOD
        rate = (3.0 * (error - last[2]) + last[0] - last[1]) / (10.0 * PERIOD)
        last = [error, *last[:2]]
        found.append(v["KP"] * (error + total / v["TR"] + rate * v.get("TD", 0.0)))
    return np.array(found)


def velocity(case, key, with_error_first):
    """PIDE and the fieldbus block: increments in percent of range, minutes or seconds."""
    v, said = entered(key, case)
    gain = v.get("KC", v.get("GAIN"))
    reset = v["TI"] * 60.0 if "TI" in v else v["RESET"]
    direct = said.get("control action") == "E = PV − SP"
    direct = direct or said.get("CONTROL_OPTS, Direct Acting") == "true"
    setpoint, measurement = (100.0 * each / 5.0 for each in records())
    sign = -1.0 if direct else 1.0
    output, last_error, last_pv = OUTPUT / 10.0 * 100.0, 0.0, measurement[0]
    found = []
    for sp, pv in zip(setpoint, measurement, strict=True):
        error = sp - pv
        first = error - last_error if with_error_first else last_pv - pv
        output += sign * gain * (first + PERIOD / reset * error)
        last_error, last_pv = error, pv
        found.append(output / 100.0 * 10.0)
    return np.array(found)


@pytest.mark.parametrize("gain", [4.0, -4.0])
def test_the_standard_s_example_integrates_one_sample_earlier_and_else_is_the_law(gain):
    case = tuning(gain, 20.0)
    setpoint, measurement = records()
    earlier = gain * PERIOD / 20.0 * (setpoint - measurement)
    assert iec_61131_3(case) == pytest.approx(own_output(case) + earlier, abs=1e-11)


def test_the_standard_s_derivative_is_the_law_s_on_a_ramp():
    """Both have the slope as soon as their memories are full of it."""
    slope, error = 0.3, []
    last = [0.0, 0.0, 0.0]
    for k in range(8):
        value = slope * PERIOD * k
        error.append((3.0 * (value - last[2]) + last[0] - last[1]) / (10.0 * PERIOD))
        last = [value, *last[:2]]
    assert error[4:] == pytest.approx([slope] * 4, rel=1e-12)


@pytest.mark.parametrize("gain", [4.0, -4.0])
@pytest.mark.parametrize(
    ("key", "weight"),
    [
        ("rockwell-pide-dependent", 1.0),
        ("rockwell-pide-dependent", 0.0),
        ("yokogawa-fieldbus-pid", 1.0),
        ("yokogawa-fieldbus-pid", 0.0),
    ],
)
def test_velocity_blocks_are_the_velocity_form(key, weight, gain):
    case = tuning(gain, 30.0, weight=weight, form=PidForm("PI", "velocity"))
    theirs = velocity(case, key, with_error_first=weight == 1.0)
    assert theirs == pytest.approx(own_output(case), abs=1e-11)
    # The positional form takes the error one sample later: what is left of the last one.
    positional = tuning(gain, 30.0, weight=weight)
    setpoint, measurement = records()
    late = gain * PERIOD / 30.0 * (setpoint - measurement)
    assert theirs - late == pytest.approx(own_output(positional), abs=1e-11)


def test_series_and_isa_are_one_law_where_the_integral_takes_this_sample_s_error():
    """So blocks with a backward integral and derivative need no more than the algebra."""
    gain, ti, td, tf = 2.0, 10.0, 2.5, 0.5
    case = tuning(gain * 1.25, 12.5, 1.9, tf, 1.0, PidForm("PID", derivative_on="error"))
    v, _ = entered("emerson-deltav-series", case)
    assert [v["GAIN"], v["RESET"], v["RATE"], v["ALPHA"]] == [gain * 0.5, ti, td, tf / td]
    random = np.random.default_rng(8)
    filtered = kept = integral = isa_integral = 0.0
    series, isa = [], []
    for error in random.normal(size=300):
        rate = (error - filtered) / (v["ALPHA"] * v["RATE"] + PERIOD)
        filtered += PERIOD * rate
        lead = error + v["RATE"] * rate
        integral += PERIOD / v["RESET"] * lead
        series.append(v["GAIN"] * (lead + integral))
        rate = (error - kept) / (tf + PERIOD)
        kept += PERIOD * rate
        isa_integral += PERIOD / 12.5 * error
        isa.append(0.5 * gain * 1.25 * (error + isa_integral + 1.9 * rate))
    assert series == pytest.approx(isa, abs=1e-12)
