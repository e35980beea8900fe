"""Every form of the PID against its transfer function, continuous and sampled."""

import numpy as np
import pytest
from pid_rig import forms, name_of, one_loop, settings
from scipy.signal import lfilter

GAIN, INTEGRAL_TIME, DERIVATIVE_TIME, FILTER, WEIGHT = 1.7, 4.0, 1.2, 2.0, 0.4
FILTER_TIME = DERIVATIVE_TIME / FILTER
BIAS = 50.0

every_form = pytest.mark.parametrize("form", forms(), ids=name_of)


def values_of(form):
    return settings(
        form, gain=GAIN, integral_time=INTEGRAL_TIME, derivative_time=DERIVATIVE_TIME,
        derivative_filter=FILTER, weight=WEIGHT,
    ) | {"pump_1.low_limit": -1e6, "pump_1.high_limit": 1e6}  # fmt: skip


def response(form, time_step, setpoint, measurement):
    """The law's output, from rest, less its bias."""
    law = one_loop(form, values_of(form), rest=0.0, output=BIAS, time_step=time_step)
    return np.array(
        [
            law.moved(level_1_sp=r, level_1_pv=y) - BIAS
            for r, y in zip(setpoint, measurement, strict=True)
        ]
    )


def transfer(form, proportional, integral, derivative, both):
    """Return the controller's action on the setpoint and on minus the measurement.

    The arguments are what the four elements 1, 1/s, s/(1 + s Tf) and 1/(1 + s Tf) do: numbers or
    arrays. The last is the integral of the derivative, which only the series form has.
    """
    integral = GAIN / INTEGRAL_TIME * integral * form.has_integral
    acts = GAIN * DERIVATIVE_TIME * derivative * form.has_derivative
    if form.algorithm == "series" and form.has_derivative and form.has_integral:
        acts = acts + GAIN * DERIVATIVE_TIME / INTEGRAL_TIME * both
    from_error = GAIN * proportional + integral + acts
    from_setpoint = GAIN * WEIGHT * proportional + integral
    if form.derivative_on == "error":
        from_setpoint = from_setpoint + acts
    return from_setpoint, from_error


def analytic(form, way, shape, time):
    """The continuous form's response to a unit step or ramp at t = 0."""
    decay = np.exp(-time / FILTER_TIME)
    if shape == "step":
        elements = 1.0, time, decay / FILTER_TIME, 1 - decay
    else:
        elements = time, time**2 / 2, 1 - decay, time - FILTER_TIME * (1 - decay)
    return transfer(form, *elements)[way == "measurement"]


@pytest.mark.sampled
@pytest.mark.parametrize("shape", ["step", "ramp"])
@pytest.mark.parametrize("way", ["setpoint", "measurement"])
@every_form
def test_response_tends_to_that_of_the_continuous_form_with_the_time_step(form, way, shape):
    # Not at t = 2 Tf, where the first-order error of a sampled decay changes its sign.
    times = np.array([0.4, 0.8, 3.0])
    expected = np.array([analytic(form, way, shape, time) for time in times])
    found, errors = [], []
    for time_step in (0.02, 0.01):
        count = round(times[-1] / time_step) + 1
        signal = np.ones(count) if shape == "step" else time_step * np.arange(count)
        given = (signal, 0 * signal) if way == "setpoint" else (0 * signal, -signal)
        output = response(form, time_step, *given)[np.rint(times / time_step).astype(int)]
        found.append(output)
        errors.append(output - expected)
    differentiated = form.has_derivative and (way == "measurement" or form.derivative_on == "error")
    # Sums of constants are exact: no part then depends on the time step. A velocity form may
    # take the error of this sample or of the last, one time step apart.
    integral_is_exact = not form.has_integral or (shape == "step" and form.algorithm != "velocity")
    if integral_is_exact and not differentiated:
        assert np.max(np.abs(errors)) < 1e-12
        return
    # First order: half the error with half the time step, and what is left of it by
    # extrapolation is of second order.
    assert errors[0] == pytest.approx(2 * errors[1], rel=0.1)
    left = 2 * found[1] - found[0] - expected
    assert np.max(np.abs(left)) < 0.05 * np.max(np.abs(errors[1]))


@every_form
def test_response_is_that_of_the_sampled_transfer_function(form):
    """Random setpoint and measurement; the other route is SciPy's filter of the polynomials."""
    random, time_step, samples = np.random.default_rng(11), 0.3, 500
    setpoint, measurement = np.cumsum(random.normal(scale=0.2, size=(2, samples)), axis=1)
    pole = FILTER_TIME / (FILTER_TIME + time_step)
    filtered, whole = np.array([1.0, -pole]), np.array([1.0, -1.0])
    slope = 1 / (FILTER_TIME + time_step)
    # Forward differences for the integral, but for the velocity form, which takes the error of
    # the sample in which it moves; backward differences for the derivative.
    late = [time_step, 0.0] if form.algorithm == "velocity" else [0.0, time_step]
    common = np.convolve(whole, filtered)
    numerators = transfer(
        form,
        common,
        np.convolve(late, filtered),
        slope * np.convolve(whole, whole),
        slope * np.convolve(late, whole),
    )
    expected = sum(
        lfilter(numerator, common, signal)
        for numerator, signal in zip(numerators, (setpoint, -measurement), strict=True)
    )
    assert response(form, time_step, setpoint, measurement) == pytest.approx(expected, abs=1e-11)


def frequency_response(form, values, time_step, frequencies):
    """The law from its response to an impulse of the measurement, whose integral is taken out."""
    law = one_loop(form, values, rest=0.0, output=BIAS, time_step=time_step)
    samples = round(20 * FILTER_TIME / time_step)
    impulse = [-1.0] + [0.0] * (samples - 1)
    output = np.array([law.moved(level_1_pv=y) - BIAS for y in impulse])
    differences = np.diff(output, prepend=0.0)
    delay = np.exp(-1j * frequencies * time_step)
    return np.polynomial.polynomial.polyval(delay, differences) / (1 - delay)


FREQUENCIES = np.logspace(-2, 0.7, 12)  # [rad/s]


@pytest.mark.parametrize(
    ("first", "second"), [("isa", "parallel"), ("isa", "velocity"), ("isa", "series")]
)
def test_forms_agree_in_frequency_response_when_their_settings_are_converted(first, second):
    """C(s) of each form at s = jω, and of the isa form that is equivalent to a series one.

    With equal filters, K/Ti (1 + (Ti + Tf) s + Ti (Td + Tf) s²) is to be
    K'/Ti' (1 + Ti' s) (1 + (Td' + Tf) s); both stand over s (1 + Tf s).
    """
    time, derivative = INTEGRAL_TIME, DERIVATIVE_TIME
    if second == "series":
        time = INTEGRAL_TIME + DERIVATIVE_TIME
        derivative = INTEGRAL_TIME * (DERIVATIVE_TIME + FILTER_TIME) / time - FILTER_TIME
    gain = GAIN * time / INTEGRAL_TIME
    one, other = (form for form in forms() if name_of(form) in (
        f"{first}-PID-on-measurement", f"{second}-PID-on-measurement"))  # fmt: skip
    equivalent = settings(
        one, gain=gain, integral_time=time, derivative_time=derivative,
        derivative_filter=derivative / FILTER_TIME,
    ) | {"pump_1.low_limit": -1e6, "pump_1.high_limit": 1e6}  # fmt: skip
    s = 1j * FREQUENCIES
    differentiator = s / (1 + s * FILTER_TIME)
    continuous = gain * (1 + 1 / (time * s) + derivative * differentiator)
    if second == "series":  # the equation of the series form is the same function
        series = GAIN * (1 + 1 / (INTEGRAL_TIME * s)) * (1 + DERIVATIVE_TIME * differentiator)
        assert series == pytest.approx(continuous, rel=1e-13)
    away = []
    for time_step in (0.02, 0.01):
        found = (
            frequency_response(one, equivalent, time_step, FREQUENCIES),
            frequency_response(other, values_of(other), time_step, FREQUENCIES),
        )
        away.append([(values - continuous) / continuous for values in found])
    for coarse, fine in zip(*away, strict=True):
        assert coarse == pytest.approx(2 * fine, rel=0.1)  # first order in the time step …
        assert np.max(np.abs(fine)) < 0.01 * np.max(FREQUENCIES)  # … of at most ω Δt
        assert np.max(np.abs(2 * fine - coarse)) < 1e-3
