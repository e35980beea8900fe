"""Verdicts follow from numbers alone."""

import pytest
from sympy import symbols

from clepsydra.papers.comparison import (
    circular,
    claimed,
    compared,
    compared_formula,
    damaged,
    remark,
)
from clepsydra.papers.printed import printed_number
from clepsydra.papers.row_words import printed_words


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
    assert compared("t", "n", "1", 0.768, digits=2, right_if=[("sum", True)]).verdict == "misprint"


@pytest.mark.parametrize("text", ["", ".", "-", "3,5", "1.2.3", "e5", "NaN", "3 cm"])
def test_what_is_no_number_is_refused(text):
    with pytest.raises(ValueError, match="no printed number"):
        printed_number(text)


@pytest.mark.parametrize("computed", [2.65, 2.55, 2.6499, 2.6])
def test_a_number_that_rounds_to_the_printed_one_is_reproduced(computed):
    assert compared("t", "n", "2.6", computed).verdict == "reproduced"


@pytest.mark.parametrize("computed", [2.7, 2.5499, -2.6, -2.65, float("nan"), float("inf")])
def test_any_other_is_not(computed):
    row = compared("t", "n", "2.6", computed, unprinted="the horizon is not printed")
    assert (row.verdict, row.reason) == ("not reproducible", "the horizon is not printed")


@pytest.mark.parametrize(
    ("printed", "computed"), [("64.93", 64.9351), ("-2.6", -2.699), ("1", 1.9)]
)
def test_a_number_may_be_cut_after_its_last_digit(printed, computed):
    row = compared("t", "n", printed, computed, why="1/A.")
    assert (row.verdict, row.reason) == ("reproduced", "1/A. Cut after its last digit.")


def test_a_bare_zero_leaves_nothing_open():
    assert compared("t", "n", "0", 0.0).verdict == "reproduced"
    for computed in (0.4, -0.4, 0.9):
        assert compared("t", "n", "0", computed, why="w").verdict == "not reproducible"


def test_a_tolerance_counts_beside_the_digits_and_needs_its_reason():
    assert compared("t", "n", "100", 103.0, tolerance=0.03, why="noise").verdict == "reproduced"
    row = compared("t", "n", "100", 103.0, tolerance=0.02, why="noise")
    assert row.verdict == "not reproducible"
    with pytest.raises(ValueError, match="needs its reason"):
        compared("t", "n", "100", 103.0, tolerance=0.03)


def test_two_zeros_agree_without_a_difference():
    row = compared("t", "n", "-2.561E-15", -1.4e-14, zero=1e-11, why="both are rounding")
    assert (row.verdict, row.difference) == ("reproduced", None)


def test_a_misprint_needs_all_its_evidence():
    given = {"place": "t", "name": "n", "printed": "0.1092", "computed": 10.92}
    both = [("one", True), ("other", True)]
    assert compared(**given, right_if=both).verdict == "misprint"
    row = compared(**given, right_if=[("one", True), ("other", False)])
    assert (row.verdict, row.reason) == ("not reproducible", "other")
    with pytest.raises(ValueError, match="no reason"):
        compared(**given)


def test_evidence_does_not_make_a_misprint_of_what_is_reproduced():
    assert compared("t", "n", "2.6", 2.6, right_if=[("one", True)]).verdict == "reproduced"


def test_a_print_is_shown_with_all_its_digits():
    row = compared("Table 7", "IE", "0.380", 0.3799)
    assert (row.printed, printed_words(row)) == (0.38, "0.380")
    assert printed_words(claimed("t", "n", "no overshoot", True, "1", reason="r")) == "no overshoot"


def test_differences_are_relative_to_the_print():
    assert compared("t", "n", "-2.0", -2.09, unprinted="u").difference == pytest.approx(-0.045)
    assert compared("t", "n", "0", 0.1, unprinted="u").difference is None


def test_formulas_are_equal_for_all_values():
    s, gain, time = symbols("s K_p T_i")
    closed = gain * (1 + time * s) / (s**2 * time + s * time * gain + gain)
    same = 1 / (1 + s * time * s / (gain * (1 + time * s)))
    assert compared_formula("(73)", "V", closed, same).verdict == "reproduced"
    other = gain * (1 + time * s) / (s**2 * time * gain + gain)
    assert compared_formula("(56)", "V", other, closed, reason="(42)").verdict == "misprint"


def test_claims_hold_or_fail():
    assert claimed("t", "n", "c", True, "1", reason="r").verdict == "claim holds"
    assert claimed("t", "n", "c", False, "1", reason="r").verdict == "claim fails"


def test_agreement_with_what_it_was_solved_from_is_no_reproduction():
    row = compared("t", "n", "2.6", 2.6, why="The integral.")
    again = circular(row, "The step was solved from this cell.")
    assert again.verdict == "consistent" and not again.is_counted and again.is_as_printed
    assert again.reason == "The step was solved from this cell. The integral."
    assert circular(claimed("t", "n", "c", True, "1", reason="r"), "w").verdict == "consistent"


def test_what_was_solved_from_a_number_and_contradicts_it_stays_a_finding():
    row = compared("t", "n", "2.6", 9.0, right_if=[("sum", True)])
    assert circular(row, "w") is row and row.is_counted


def test_damage_of_the_conversion_is_not_the_authors_misprint():
    for row in (
        compared("t", "n", "2.6", 9.0, right_if=[("sum", True)]),
        compared("t", "n", "2.6", 9.0, unprinted="u"),
    ):
        again = damaged(row, "A bar of a fraction is lost.")
        assert again.verdict == "damaged text" and not again.is_counted and again.is_as_printed
        assert again.reason == f"A bar of a fraction is lost. {row.reason}"
    right = compared("t", "n", "2.6", 2.6)
    assert damaged(right, "w") is right


def test_a_remark_of_ours_judges_nothing():
    row = remark("t", "n", "nothing is said", "1", reason="r")
    assert row.verdict == "remark" and not row.is_counted and row.is_as_printed
