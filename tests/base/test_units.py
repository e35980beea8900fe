"""Quantities with units: exact conversion, and a message for everything that is none."""

import math
from fractions import Fraction

import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.base.units import from_si, split_quantity, to_si


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("28 cm^2", "m^2", 0.0028),
        ("0.071 cm^2", "m^2", 7.1e-6),
        ("0.057 cm²", "m^2", 5.7e-6),
        ("3.33 cm^3/(s V)", "m^3/(s V)", 3.33e-6),
        ("3.14 cm^3/s/V", "m^3/(s V)", 3.14e-6),
        ("3.33 cm3/(s V)", "m^3/(s V)", 3.33e-6),
        ("3.6 m3/h", "m^3/s", 0.001),
        ("28 cm2", "m^2", 0.0028),
        ("2 s2/m5", "s^2/m^5", 2.0),
        ("0.5 V/cm", "V/m", 50.0),
        ("981 cm/s^2", "m/s^2", 9.81),
        ("981 cm*s^-2", "m/s^2", 9.81),
        ("50 %", "1", 0.5),
        ("50%", "1", 0.5),
        ("0.7", "1", 0.7),
        (0.7, "1", 0.7),
        (1, "1", 1.0),
        ("0.1 s", "s", 0.1),
        ("3 min", "s", 180.0),
        ("1.5 l/min", "m^3/s", 2.5e-5),
        ("-1e-3 km", "m", -1.0),
        (" 2.50  mm ", "m", 0.0025),
        ("3.6 m**3/h", "m^3/s", 0.001),
        ("2 gallon", "m^3", 2 * 3.785411784e-3),
        ("4 1/min", "1/s", 4 / 60),
        ("0 cm", "m", 0.0),
        # Not among the units that load at once.
        ("1 yard", "m", 0.9144),
    ],
)
def test_value(text: object, unit: str, value: float) -> None:
    assert to_si(text, unit, "here") == value


def test_rounds_once() -> None:
    """Every value is the double nearest to the decimal that was written, by exact fractions."""
    for thousandths in range(1, 2000, 7):
        text = f"{thousandths / 1000:.3f}"
        exact = Fraction(thousandths, 1000) / 10_000
        assert to_si(f"{text} cm^2", "m^2", "here") == float(exact)


def test_there_and_back() -> None:
    for tenths in range(1, 400):
        shown = tenths / 10
        assert from_si(to_si(f"{shown} cm", "m", "here"), "m", "cm") == shown
    assert from_si(0.7, "1", "%") == 70.0
    assert from_si(math.inf, "m", "cm") == math.inf
    assert from_si(0.3, "m", "m") == 0.3


EXPECTED_LENGTH = "expected a quantity convertible to m"
EXAMPLE = "write it as in '1 m'."


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("5", f"got '5', {EXPECTED_LENGTH}; the unit is missing: {EXAMPLE}"),
        (5, f"got 5, {EXPECTED_LENGTH}; the unit is missing: {EXAMPLE}"),
        (5.0, f"got 5.0, {EXPECTED_LENGTH}; the unit is missing: {EXAMPLE}"),
        ("", f"got '', {EXPECTED_LENGTH}; {EXAMPLE}"),
        ("cm", f"got 'cm', {EXPECTED_LENGTH}; {EXAMPLE}"),
        (True, f"got True, {EXPECTED_LENGTH}; {EXAMPLE}"),
        (None, f"got None, {EXPECTED_LENGTH}; {EXAMPLE}"),
        ("5 s", f"got '5 s', {EXPECTED_LENGTH}; 's' measures something else: {EXAMPLE}"),
        ("5 cmm", f"got '5 cmm', {EXPECTED_LENGTH}; the unit 'cmm' is unknown: {EXAMPLE}"),
        ("5 m2", f"got '5 m2', {EXPECTED_LENGTH}; 'm^2' measures something else: {EXAMPLE}"),
        ("5 m23", f"got '5 m23', {EXPECTED_LENGTH}; the unit 'm23' is unknown: {EXAMPLE}"),
        ("3,3 m", f"got '3,3 m', {EXPECTED_LENGTH}; write decimals with a point, as in \"3.3 m\"."),
        ("1e400 cm", f"got '1e400 cm', {EXPECTED_LENGTH}, finite; {EXAMPLE}"),
        ("1e308 km", f"got '1e308 km', {EXPECTED_LENGTH}, finite; {EXAMPLE}"),
        ("nan cm", f"got 'nan cm', {EXPECTED_LENGTH}, finite; {EXAMPLE}"),
        ("-inf cm", f"got '-inf cm', {EXPECTED_LENGTH}, finite; {EXAMPLE}"),
        (math.nan, f"got nan, {EXPECTED_LENGTH}, finite; {EXAMPLE}"),
        (
            "5 __import__('os')",
            f"got \"5 __import__('os')\", {EXPECTED_LENGTH}; "
            f"\"__import__('os')\" cannot be used as a unit: {EXAMPLE}",
        ),
        ("5 __import__", "got '5 __import__', " + EXPECTED_LENGTH + "; the unit '__import__' is "
         f"unknown: {EXAMPLE}"),
        ("5 cm\nm", f"got '5 cm\\nm', {EXPECTED_LENGTH}; {EXAMPLE}"),
        ("5 \x1b[2Jm", f"got '5 \\x1b[2Jm', {EXPECTED_LENGTH}; '\\x1b[2Jm' cannot be used as a "
         f"unit: {EXAMPLE}"),
    ],
)  # fmt: skip
def test_message(text: object, message: str) -> None:
    with pytest.raises(InputError) as caught:
        to_si(text, "m", "plant.toml, line 3")
    assert str(caught.value) == f"plant.toml, line 3: {message}"


@pytest.mark.parametrize("text", ["20 degC", "20 °F"])
def test_scale_with_an_offset_is_refused(text: str) -> None:
    """A factor alone would turn 20 °C into 5483 K."""
    with refused(remedy="cannot be used as a unit"):
        to_si(text, "K", "here")


@pytest.mark.parametrize(
    "text",
    [
        "5 cm^9^9^9",
        "5 cm**9**9**9",
        "5 (cm^9)^9",
        "5 cm^999999999",
        "5 cm⁹⁹⁹⁹⁹⁹⁹⁹⁹",
        "5 " + "(" * 50 + "m" + ")" * 50,
        "5 " + "(" * 1_000_000,
        "5 " + "m" * 1_000_000,
        "1e999999999 cm",
        "9" * 5000 + " cm",
        "5 m//s",
        "5 m *",
        "5 ^2",
        "5 m + m",
        "5 m.s",
    ],
)
def test_hostile_text_is_refused_briefly(text: str) -> None:
    with pytest.raises(InputError) as caught:
        to_si(text, "m", "here")
    assert len(str(caught.value)) < 400


def test_underflow_is_zero() -> None:
    assert to_si("1e-999999999 cm", "m", "here") == 0.0


def test_split() -> None:
    assert split_quantity("3.33 cm^3/(s V)") == ("3.33", "cm^3/(s V)")
    assert split_quantity(".5e-3V") == (".5e-3", "V")
    assert split_quantity("5eV") == ("5", "eV")
    assert split_quantity("tank") is None
