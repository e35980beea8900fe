"""Verdicts follow from numbers alone."""

import pytest

from clepsydra.papers.printed import Printed, printed_number
from clepsydra.papers.rational_function import symbols


def line(text, **more):
    return Printed("t", "n", 1, text, **more)


@pytest.mark.parametrize(
    ("text", "value", "half_unit"),
    [
        ("0.5", 0.5, 0.05),
        (".5", 0.5, 0.05),
        ("5744", 5744.0, 0.5),
        ("8.000", 8.0, 0.0005),
        ("-1.2247", -1.2247, 0.00005),
        ("−2.6", -2.6, 0.05),
        ("8.325E-4", 8.325e-4, 0.0005e-4),
        ("2.799e−06", 2.799e-6, 0.0005e-6),
    ],
)
def test_the_digits_of_a_printed_number_say_what_rounding_leaves_open(text, value, half_unit):
    number = printed_number(text)
    assert number.value == value
    assert number.half_unit == pytest.approx(half_unit, rel=1e-12)


def test_digits_that_the_print_leaves_out_count_where_they_are_given():
    assert printed_number("0.2", digits=2).half_unit == pytest.approx(0.005)
    assert printed_number("1000", digits=4).half_unit == pytest.approx(0.5)
    assert line("1", digits=2).compared(0.768, right_if=[("sum", True)]).verdict == "misprint"


@pytest.mark.parametrize("text", ["", ".", "-", "3,5", "1.2.3", "e5", "NaN", "3 cm"])
def test_what_is_no_number_is_refused(text):
    with pytest.raises(ValueError, match="no printed number"):
        printed_number(text)


@pytest.mark.parametrize("computed", [2.65, 2.55, 2.6499, 2.6])
def test_a_number_that_rounds_to_the_printed_one_is_reproduced(computed):
    assert line("2.6").compared(computed).verdict == "reproduced"


@pytest.mark.parametrize("computed", [2.7, 2.5499, -2.6, -2.65, float("nan"), float("inf")])
def test_any_other_is_not(computed):
    row = line("2.6").compared(computed, unprinted="the horizon is not printed")
    assert (row.verdict, row.reason) == ("not reproducible", "the horizon is not printed")


@pytest.mark.parametrize(
    ("printed", "computed"), [("64.93", 64.9351), ("-2.6", -2.699), ("1", 1.9)]
)
def test_a_number_may_be_cut_after_its_last_digit(printed, computed):
    row = line(printed, note="1/A.").compared(computed)
    assert (row.verdict, row.reason) == ("reproduced", "1/A. Cut after its last digit.")


def test_a_bare_zero_leaves_nothing_open():
    assert line("0").compared(0.0).verdict == "reproduced"
    for computed in (0.4, -0.4, 0.9):
        assert line("0", note="w").compared(computed).verdict == "not reproducible"


def test_a_tolerance_counts_beside_the_digits_and_needs_its_reason():
    assert line("100", note="noise").compared(103.0, tolerance=0.03).verdict == "reproduced"
    row = line("100", note="noise").compared(103.0, tolerance=0.02)
    assert row.verdict == "not reproducible"
    with pytest.raises(ValueError, match="needs its reason"):
        line("100").compared(103.0, tolerance=0.03)


def test_two_zeros_agree_without_a_difference():
    row = line("-2.561E-15", note="rounding").compared(-1.4e-14, zero=1e-11)
    assert (row.verdict, row.difference) == ("reproduced", None)


def test_a_misprint_needs_all_its_evidence():
    printed = line("0.1092")
    both = [("one", True), ("other", True)]
    assert printed.compared(10.92, right_if=both).verdict == "misprint"
    row = printed.compared(10.92, right_if=[("one", True), ("other", False)])
    assert (row.verdict, row.reason) == ("not reproducible", "other")
    with pytest.raises(ValueError, match="no reason"):
        printed.compared(10.92)


def test_evidence_does_not_make_a_misprint_of_what_is_reproduced():
    assert line("2.6").compared(2.6, right_if=[("one", True)]).verdict == "reproduced"


def test_a_print_is_shown_with_all_its_digits():
    row = line("0.380").compared(0.3799)
    assert (row.printed, row.shown) == (0.38, "0.380")
    assert line("no overshoot").claimed(True, "1").shown == "no overshoot"


def test_differences_are_relative_to_the_print():
    assert line("-2.0").compared(-2.09, unprinted="u").difference == pytest.approx(-0.045)
    assert line("0").compared(0.1, unprinted="u").difference is None


def test_formulas_are_equal_for_all_values():
    s, gain, time = symbols("s K_p T_i")
    closed = gain * (1 + time * s) / (s**2 * time + s * time * gain + gain)
    printed = line("1/(1 + s*T_i*s/(K_p*(1 + T_i*s)))", note="(42)")
    assert printed.formula(closed).verdict == "reproduced"
    other = line("K_p*(1 + T_i*s)/(s**2*T_i*K_p + K_p)", note="(42)")
    row = other.formula(closed)
    assert (row.verdict, row.reason, row.printed) == ("misprint", "(42)", other.text)


def test_printed_names_may_mean_others_and_one_formula_may_stand_for_several():
    one, two = symbols("u_1 u_2")
    printed = line("2*u_1", note="r")
    assert printed.formula(2 * two, names={"u_1": two}).verdict == "reproduced"
    cases = [(2 * one, {}), (2 * two, {"u_1": two})]
    assert printed.formula_in(cases).computed == "2*u_1"
    row = printed.formula_in([*cases, (3 * two, {"u_1": two})])
    assert (row.verdict, row.computed) == ("misprint", "3*u_2")


def test_claims_hold_or_fail():
    assert line("c").claimed(True, "1").verdict == "claim holds"
    assert line("c").claimed(False, "1").verdict == "claim fails"


def test_agreement_with_what_it_was_solved_from_is_no_reproduction():
    row = line("2.6", note="The integral.").compared(2.6)
    again = row.circular("The step was solved from this cell.")
    assert again.verdict == "consistent" and not again.is_counted and again.is_as_printed
    assert again.reason == "The step was solved from this cell. The integral."
    assert line("c").claimed(True, "1").circular("w").verdict == "consistent"


def test_what_was_solved_from_a_number_and_contradicts_it_stays_a_finding():
    row = line("2.6").compared(9.0, right_if=[("sum", True)])
    assert row.circular("w") is row and row.is_counted


def test_damage_of_the_conversion_is_not_the_authors_misprint():
    lost = "A bar of a fraction is lost."
    for given in ({"right_if": [("sum", True)]}, {"unprinted": "u"}):
        row = line("2.6").compared(9.0, **given)
        again = line("2.6", damage=lost).compared(9.0, **given)
        assert again.verdict == "damaged text" and not again.is_counted and again.is_as_printed
        assert again.reason == f"{lost} {row.reason}"
    assert line("2.6", damage=lost, note="n").stated("2.7", False).verdict == "damaged text"
    assert line("2.6", damage=lost).compared(2.6) == line("2.6").compared(2.6)


def test_the_note_of_a_line_is_the_reason_with_what_was_found_in_it():
    noted = line("2.6", note="From (3).")
    assert noted.compared(2.6).reason == noted.compared(9.0).reason == "From (3)."
    assert noted.claimed(True, "1").reason == "From (3)."
    found = line("2.6", note="From {place}, {value:.2f} m.").told(place="(4)", value=2.601)
    assert found.compared(2.6).reason == found.remark("1").reason == "From (4), 2.60 m."
    with pytest.raises(KeyError):
        line("2.6", note="From {place}.").told(value=2.601)


def test_a_remark_of_ours_judges_nothing():
    row = line("nothing is said").remark("1")
    assert row.verdict == "remark" and not row.is_counted and row.is_as_printed
