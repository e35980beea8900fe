import math
import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from clepsydra import Signal
from clepsydra.base.units import unit_text
from clepsydra.report.quantities import (
    number_text,
    quantity_text,
    sensor_scale,
    setting_time,
    short_text,
    time_cell,
)


def read(text):
    return float(text.replace("−", "-"))


@given(st.floats(1e-12, 1e12), st.sampled_from([-1.0, 1.0]), st.integers(1, 6))
def test_a_printed_number_is_within_half_a_unit_of_its_last_digit(size, sign, digits):
    error = abs(read(number_text(sign * size, digits)) - sign * size)
    assert error <= 0.5001 * 10.0 ** (math.floor(math.log10(size)) - digits + 1)


@given(st.floats(1e-3, 1e5), st.integers(1, 6))
def test_a_printed_number_has_no_more_than_the_digits_asked_for(size, digits):
    text = number_text(size, digits).replace(".", "").lstrip("0")
    if size < 10 ** (digits - 1):
        assert len(text) == digits


def test_what_is_no_number_is_printed_as_a_sign():
    assert [number_text(x) for x in (math.nan, math.inf, -math.inf, 0.0)] == ["–", "∞", "−∞", "0"]


def test_rounding_up_to_the_next_power_does_not_add_a_digit():
    assert number_text(9.996) == "10.0"
    assert number_text(99.96) == "100"


def test_minus_signs_are_as_wide_as_plus_signs():
    assert number_text(-1.5) == "−1.50"
    assert short_text(-1.5) == "−1.5"


def test_units_are_written_with_exponents():
    assert unit_text("cm^2") == "cm²"
    assert unit_text("m**3/s") == "m³/s"
    assert not re.search(r"[*^]", unit_text("cm^3/(s V)"))


def test_a_quantity_is_shown_in_its_display_unit():
    assert quantity_text(Signal("inflow", "m^3/s", "cm^3/s"), 1.5e-6) == "1.50 cm³/s"
    assert quantity_text(Signal("share"), 0.5) == "0.500"


def test_a_setpoint_in_volts_is_the_level_that_the_sensor_would_read(process):
    scale = sensor_scale(process, "level_2")
    # Johansson's sensors: 0.5 V/cm, nothing at the floor.
    assert np.allclose(scale.to_state(np.array([0.0, 6.2])), [0.0, 0.124], rtol=1e-14, atol=1e-16)


@given(st.floats(1e-3, 9e5))
def test_a_time_is_what_it_says_in_each_of_its_forms(time):
    length = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
    for text in (time_cell(time), *setting_time(time).split(" = ")):
        number, unit = text.split(" ")
        assert math.isclose(read(number) * length[unit], time, rel_tol=0.0051), text
        assert "e" not in number, text


def test_what_an_engineer_enters_is_in_seconds_first():
    assert setting_time(180.0) == "180.0 s"
    assert setting_time(10363.0) == "10360 s = 173 min"
    assert time_cell(math.inf) == "∞" and setting_time(math.inf) == "∞ s"
