"""The forms of PID settings and their units: against the transfer functions they stand for."""

import math

import pytest
from refusals import refused

from clepsydra import PidForm, Signal
from clepsydra.designs.gain_units import gain_from_percent, percent_gain, unit_of_gain
from clepsydra.designs.loops.multiloop import law_settings
from clepsydra.designs.loops.pid_settings import (
    ParallelSettings,
    PidSettings,
    SeriesSettings,
    from_parallel,
    from_series,
    to_parallel,
    to_series,
)

LEVEL = Signal("level", "m", low=1.0, high=5.0)
VALVE = Signal("valve", "1", low=0.0, high=1.0)


@pytest.mark.parametrize("s", [0.01j, 0.3j, 2.0 + 1.0j])
@pytest.mark.parametrize(
    "series",
    [
        SeriesSettings(2.0, 30.0, 5.0),
        SeriesSettings(-0.4, 3.0, 3.0),
        SeriesSettings(2.0, 30.0, 0.0),
        SeriesSettings(2.0, math.inf, 5.0),
    ],
)
def test_all_forms_are_one_transfer_function(series, s):
    K, Ti, Td = series
    expected = K * (1 + 1 / Ti / s) * (1 + Td * s)
    isa = from_series(series)
    assert isa.gain * (1 + 1 / isa.integral_time / s + isa.derivative_time * s) == (
        pytest.approx(expected, rel=1e-13)
    )
    parallel = to_parallel(isa)
    assert parallel.gain + parallel.integral_gain / s + parallel.derivative_gain * s == (
        pytest.approx(expected, rel=1e-13)
    )
    assert from_parallel(parallel) == pytest.approx(isa, rel=1e-14)


def test_series_form_comes_back_with_its_longer_time_as_integral_time():
    assert to_series(from_series(SeriesSettings(2.0, 30.0, 5.0))) == pytest.approx(
        (2.0, 30.0, 5.0), rel=1e-13
    )
    # A series form with Td' > Ti' is the same transfer function with the times exchanged.
    assert to_series(from_series(SeriesSettings(2.0, 5.0, 30.0))) == pytest.approx(
        (2.0 * 30.0 / 5.0, 30.0, 5.0), rel=1e-13
    )


def test_a_tiny_derivative_keeps_its_digits_in_series_form():
    assert to_series(PidSettings(1.0, 1e6, 1e-6)).derivative_time == pytest.approx(1e-6, rel=1e-12)


def test_the_series_form_ends_at_four_derivative_times():
    assert to_series(PidSettings(1.0, 8.0, 2.0)) == (0.5, 4.0, 4.0)
    with refused(expected="at least four times the derivative time"):
        to_series(PidSettings(1.0, 7.99, 2.0))


@pytest.mark.parametrize(
    "gains", [(0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, -1.0), (-1.0, 1.0, 0.0)]
)
def test_parallel_gains_of_two_signs_have_no_isa_form(gains):
    with refused(expected="gains of its sign"):
        from_parallel(ParallelSettings(*gains))


@pytest.mark.parametrize("gain", [-0.5, 0.125])
def test_units_go_both_ways(gain):
    # 4 m of range are 100 %: a gain of 0.5 per metre is 2 %/%.
    percent = percent_gain(gain, LEVEL, VALVE)
    assert percent == 4.0 * gain
    assert gain_from_percent(percent, LEVEL, VALVE) == gain
    assert unit_of_gain(LEVEL, VALVE) == "1/m"


def test_a_signal_without_a_range_has_no_percent():
    with refused(place="y", expected="finite range"):
        percent_gain(1.0, Signal("y", "m"), VALVE)


@pytest.mark.parametrize(("gain", "action"), [(-0.5, "direct"), (0.5, "reverse")])
def test_the_action_is_the_sign_of_the_gain(gain, action):
    assert PidSettings(gain).action == action


def test_a_law_in_series_form_refuses_complex_zeros():
    with refused(place="series form"):
        law_settings(PidSettings(1.0, 4.0, 2.0), PidForm("PID", "series"))
