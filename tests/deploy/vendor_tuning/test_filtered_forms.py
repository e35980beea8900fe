"""ISA and series form with a derivative filter are one transfer function."""

import numpy as np
import pytest
from refusals import refused

from clepsydra.deploy.vendor_tuning.filtered_forms import FilteredPid, from_series, to_series

FREQUENCIES = 1j * np.logspace(-4, 3, 60)


def isa_response(p, derivative_on, s=FREQUENCIES):
    action = p.derivative_time * s / (1 + p.filter_time * s)
    integral = 1 / (p.integral_time * s)
    setpoint = p.setpoint_weight + integral + (action if derivative_on == "error" else 0)
    return p.gain * setpoint, p.gain * (1 + integral + action)


def series_response(p, derivative_on, s=FREQUENCIES):
    lead = p.derivative_time * s / (1 + p.filter_time * s)
    integral = 1 / (p.integral_time * s)
    on_setpoint = lead if derivative_on == "error" else 0
    setpoint = p.setpoint_weight + on_setpoint + integral * (1 + on_setpoint)
    return p.gain * setpoint, p.gain * (1 + integral) * (1 + lead)


def random_series(random):
    integral_time = 10 ** random.uniform(-1, 4)
    derivative_time = integral_time * random.uniform(0.01, 0.95)
    filter_time = derivative_time * random.uniform(0.0, 0.3)
    gain = random.choice([-1, 1]) * 10 ** random.uniform(-3, 3)
    return FilteredPid(gain, integral_time, derivative_time, filter_time, random.uniform(0, 1))


@pytest.mark.parametrize("derivative_on", ["measurement", "error"])
def test_both_forms_are_one_transfer_function(derivative_on):
    random = np.random.default_rng(5)
    for _ in range(200):
        series = random_series(random)
        found = isa_response(from_series(series, derivative_on), derivative_on)
        expected = series_response(series, derivative_on)
        for one, other in zip(found, expected, strict=True):
            assert np.max(np.abs(one / other - 1)) < 1e-12


@pytest.mark.parametrize("derivative_on", ["measurement", "error"])
def test_the_way_back_is_the_same_transfer_function(derivative_on):
    random = np.random.default_rng(6)
    for _ in range(200):
        isa = from_series(random_series(random), derivative_on)
        series = to_series(isa, derivative_on)
        assert series.integral_time >= series.derivative_time
        for one, other in zip(
            series_response(series, derivative_on), isa_response(isa, derivative_on), strict=True
        ):
            # Near the double zero half of the digits of the times are lost, none of the law.
            assert np.max(np.abs(one / other - 1)) < 1e-9


def test_without_filter_it_is_the_known_algebra():
    series = to_series(FilteredPid(2.5, 12.5, 2.0), "measurement")
    # The root of 1 - 4 Td/Ti is 0.6: K (1 + 0.6)/2, Ti (1 + 0.6)/2, Ti (1 - 0.6)/2.
    assert series[:3] == pytest.approx((2.0, 10.0, 2.5), rel=1e-14)
    at_the_edge = to_series(FilteredPid(2.0, 8.0, 2.0), "measurement")
    assert at_the_edge[:3] == pytest.approx((1.0, 4.0, 4.0), rel=1e-14)


@pytest.mark.parametrize(
    "isa",
    [
        FilteredPid(2.0, 7.99, 2.0),
        # A filter takes a little more: (8.2 − 0.2)² = 64 < 4 · 8.2 · 2.
        FilteredPid(2.0, 8.2, 2.0, 0.2),
        FilteredPid(2.0, 1.0, 0.01, 5.0),
    ],
)
def test_complex_zeros_have_no_series_form(isa):
    with refused(expected="4 Ti Td", remedy="shorter derivative time"):
        to_series(isa, "measurement")


@pytest.mark.parametrize("isa", [FilteredPid(2.0, 30.0), FilteredPid(2.0, float("inf"), 3.0, 0.3)])
def test_without_integral_or_derivative_there_is_nothing_to_convert(isa):
    assert to_series(isa, "measurement") == isa
