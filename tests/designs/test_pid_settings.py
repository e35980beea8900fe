"""The forms of PID settings and their units: against the transfer functions they stand for."""

import math

import pytest
from refusals import refused

from clepsydra import InputError, PidForm, Signal
from clepsydra.designs.gain_units import (
    gain_from_percent,
    gain_units,
)
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


def test_units_of_a_direct_acting_level_controller():
    # 0.5 per metre: 4 m of range are 100 %, so 2 %/%; a band of 50 %; 3 min a repeat.
    shown = gain_units(PidSettings(-0.5, 180.0, 30.0), LEVEL, VALVE)
    assert shown.unit == "1/m"
    assert (shown.percent_gain, shown.proportional_band) == (2.0, 50.0)
    assert shown.action == "direct"
    assert shown.minutes_per_repeat == 3.0
    assert shown.repeats_per_minute == pytest.approx(1.0 / 3.0, rel=1e-15)
    assert shown.derivative_minutes == 0.5
    assert shown.parallel == pytest.approx((-0.5, -0.5 / 180.0, -15.0))
    assert shown.series is not None
    assert gain_units(PidSettings(0.5, 180.0, 50.0), LEVEL, VALVE).series is None


def test_a_controller_without_integral_repeats_never():
    shown = gain_units(PidSettings(0.5), LEVEL, VALVE)
    assert (shown.repeats_per_minute, shown.minutes_per_repeat) == (0.0, math.inf)
    assert shown.action == "reverse"


@pytest.mark.parametrize("gain", [-0.5, 0.125])
def test_units_go_both_ways(gain):
    shown = gain_units(PidSettings(gain, 90.0), LEVEL, VALVE)
    signed = math.copysign(100.0 / shown.proportional_band, gain)
    assert abs(signed) == pytest.approx(shown.percent_gain)
    assert gain_from_percent(signed, LEVEL, VALVE) == pytest.approx(gain, rel=1e-14)
    assert 60.0 / shown.repeats_per_minute == pytest.approx(90.0, rel=1e-14)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gain_units(PidSettings(0.0, 1.0), LEVEL, VALVE), "not zero"),
        (lambda: gain_units(PidSettings(math.nan, 1.0), LEVEL, VALVE), "not zero"),
        (lambda: gain_units(PidSettings(1.0, 0.0), LEVEL, VALVE), "above 0 s"),
        (lambda: gain_units(PidSettings(1.0, math.nan), LEVEL, VALVE), "above 0 s"),
        (lambda: gain_units(PidSettings(1.0, 1.0, -1.0), LEVEL, VALVE), "from 0 s"),
        (lambda: gain_units(PidSettings(1.0, 1.0), Signal("y", "m"), VALVE), "finite range"),
    ],
)
def test_what_is_no_setting_is_refused(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_a_law_in_series_form_refuses_complex_zeros():
    with refused(place="series form"):
        law_settings(PidSettings(1.0, 4.0, 2.0), PidForm("PID", "series"))
