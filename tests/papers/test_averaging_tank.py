"""What is printed wrongly is found by computation; the lists here are written by hand."""

from pathlib import Path

import numpy as np
import pytest

import clepsydra as cl
from clepsydra.papers.averaging_tank import lqi_runs

pytestmark = pytest.mark.thorough

MISPRINTS = {
    ("(12)", "f_V at rest"),
    ("(59)", "Gc21"),
    ("(60)", "GCL22"),
    ("(76)", "Gc21"),
    ("(77)", "GCL22"),
    ("(88)", "M"),
    ("(94), (96)", "rank of A"),
    ("(97b)", "Fi12"),
    ("(101a)", "Q3"),
    # References and a heading that point elsewhere, and names that stand alone.
    ("section 3.1", "reference: a PID control structure was designed according to"),
    ("section 3.1", "numbers of its subsections"),
    ("section 3.2", "system of (33) and (34)"),
    ("section 4", "reference: Q and R matrices tuned manually"),
    ("(72)", "name of the matrix"),
    ("(78)", "end of the integrals"),
    ("(92), (93)", "names of the matrices"),
}
RIGHT = {
    ("(94), (96)", "rank of A"): 1.0,
    ("(97b)", "Fi12"): 10**0.5,
    ("(101a)", "Q3"): 10.92,
}
#: One letter, sign or bar that is lost, a letter like another, and cells that ran together.
DAMAGED = {
    ("(3)", "left side"),
    ("(4)", "left side"),
    ("(13)", "first line"),
    ("(32)", "A"),
    ("(32)", "B"),
    ("(50)", "T11 by the plant"),
    ("(56)", "GCL11"),
    ("(56)", "GCL22"),
    ("(68)", "GCL11"),
    ("(68)", "GCL22"),
    ("(76)", "Gc12"),
    ("(77)", "GCL11"),
    ("(87)", "matrix before y_ref"),
    ("(94)", "M14"),
    *((place, name) for place in ("(100b)", "(101b)") for name in ("F21", "F22", "Fi21", "Fi22")),
}
FAILING = {
    ("(69)", "stability, (69)"),
    ("(73)", "stability, (73)"),
    ("(77)", "stability, (77)"),
    ("(100a)", "optimal weights"),
    ("(101a)", "optimal weights"),
    ("section 3.1.3", "PI, what IE chooses"),
    ("section 3.2", "number of inputs"),
    ("Table 6", "best values of the indices"),
}
REMARKS = {
    ("section 4", "PI, f_in with f_out constant"),
    # Of settling and by Table 6.
    ("section 4", "PI against the others"),
    # By the run's length and the largest gain; and PID, which contains PI, is as good.
    ("section 3.1.3", "best type of controller"),
    # With the exception of ISEG in one half of the sentence or both; by hand or optimal; f_out,
    # which is moved downwards, by its largest value or its excursion.
    ("section 4", "LQI, which flow"),
    ("section 4", "settling time of V, LQI"),
    ("section 4", "control effort, LQI"),
    # Of the unit nothing hangs; and of a final time, whether it is that of the run.
    ("Table 1", "unit of C_in and C"),
    ("(35)", "end of the integral"),
    # As it stands, or with its columns as they are paired.
    ("section 3.1", "diagonal, or triangular"),
    # As necessary conditions, or as sufficient ones.
    ("section 3.2", "conditions of controllability"),
    # Of what the document's search found, or of what weights can reach.
    ("section 3.2", "LQI, which index"),
    # By the smallest numbers of Table 6, or by each index of one run.
    ("section 4", "PI, lowest by IE"),
    # Of the optimal control, or of the optimisation; within the ranges, or with C_in free.
    ("section 4", "PI, wind-up with f_out constant"),
    ("section 4", "PI, overshoot of V with f_out constant"),
    # With constant outflow, or with constant inflow.
    ("section 4", "PI, settling and rise of C"),
    # To within 2 %, or to within 5 %.
    ("section 4", "PI, settling and rise with f_out constant"),
    # By how much a settling time is significantly shorter.
    ("section 4", "LQI, best with f_out constant"),
    # Of C, or of V.
    ("section 4", "LQI, what the flows act on"),
}
#: Cells that the steps, Q3 and the time of ISEG were solved from.
SOLVED_FROM = {
    *(f"IE of {output}, f_out constant, by hand" for output in ("C", "V")),
    "ISEG of C, f_out constant, by hand",
    *(f"{index} of C, f_in constant, optimal" for index in ("IAE", "ISE", "ITAE", "IE")),
}  # fmt: skip
#: Elements of T that (50) chooses, as (40) names them.
CHOSEN = {
    f"{element}{ending} ({place})"
    for ending in ("", " at rest")
    for element, place in (
        ("T12", "row 1, column 1"),
        ("T22", "row 1, column 2"),
        ("T21", "row 2, column 2"),
    )
}
#: Last digits that a solver decides, which is not printed: its step, and its derivative of errors.
OF_THE_SOLVER = {
    ("Table 7", cell)
    for cell in (
        "IAE of C, f_in constant, by hand", "ITAE of C, f_out constant, by hand",
        "ITAE of C, f_in constant, by hand", "ITAE of V, f_in constant, by hand",
        "ISEG of C, f_out constant, optimal", "ISEG of C, f_in constant, optimal",
        "ISEG of V, f_out constant, optimal",
    )
}  # fmt: skip
EXPERIMENTS = {
    "model", "cross-references", "closed-loops", "pi", "pi-claims", "pid-types",
    "expanded-system", "lqi", "optimal-weights", "lqi-claims",
}  # fmt: skip


@pytest.fixture(scope="module")
def rows(audited):
    found = audited("averaging-tank").rows
    return {(row.place, row.name): row for row in found if row.experiment in EXPERIMENTS}


def test_its_page_prints_what_the_audit_finds(page_holds):
    assert page_holds("averaging-tank")


def keys(rows, verdict):
    return {key for key, row in rows.items() if row.verdict == verdict}


def test_the_misprints_are_those_worked_out_by_hand(rows):
    assert keys(rows, "misprint") == MISPRINTS
    for key, right in RIGHT.items():
        assert rows[key].computed == pytest.approx(right, rel=3e-4)


def test_what_evaporates_has_to_flow_in_again(rows, tmp_path):
    """dV/dt by -z and dC/dt by z C0/V0, by the equilibrium of a tank that evaporates 2 mm/s."""
    row = rows["section 3.1", "evaporation z(t)"]
    assert row.computed == "dV/dt by -z, dC/dt by C_0*z/V_0"
    text = Path(lqi_runs.__file__).with_name("high_tank.toml").read_text("utf-8")
    file = tmp_path / "evaporating.toml"
    file.write_text(text.replace("[tanks.tank]", '[tanks.tank]\nevaporation = "2 mm/s"'), "utf-8")
    at = cl.load(f"{file}:outflow-constant").point.as_dict()
    assert at["inflow"] - 0.2 == pytest.approx(0.002, rel=1e-6)
    # f_in/V0 (C_in - C0) makes up for z C0/V0.
    back = at["inflow"] / 2.0 * (5.0 - at["inflow.impurity"] / 1e3)
    assert back == pytest.approx(0.002 * 5.0 / 2.0, rel=1e-6)


def test_damage_of_the_text_is_not_called_a_misprint(rows):
    assert keys(rows, "damaged text") == DAMAGED
    assert rows["(100b)", "F21"].computed == "262.4" and rows["(101b)", "F21"].computed == "256.1"


def test_what_was_solved_from_a_cell_does_not_reproduce_it(rows):
    cells = {("Table 7", name) for name in SOLVED_FROM}
    assert keys(rows, "consistent") == cells | {("(50)", name) for name in CHOSEN}


def test_what_the_document_does_not_say_is_a_remark(rows):
    assert keys(rows, "remark") == REMARKS


def test_of_table_6_only_the_signed_error_can_be_reproduced(rows):
    cells = {
        key for key in rows if key[0] == "Table 6" and key[1].split()[0] in ("IAE", "ISE", "ITAE")
    }
    contradiction = ("Table 6", "IE of C, f_in constant")
    assert len(cells) == 12
    assert keys(rows, "not reproducible") == {*cells, contradiction, *OF_THE_SOLVER}
    assert rows[contradiction].computed == pytest.approx(0.25 * 7.641e-4 / 61.5, rel=1e-4)
    for flow in ("out", "in"):
        zero = rows["Table 6", f"IE of V, f_{flow} constant"]
        assert zero.verdict == "reproduced" and abs(zero.computed) < 1e-11
        assert zero.difference is None


def test_every_printed_condition_of_stability_is_the_text_s(rows):
    """The text asks for -K_p2 > 0 at (69), (73) and (77), where the gain of -1 is there already."""
    for place in ("(69)", "(73)", "(77)"):
        assert "-K_p2 > 0" in rows[place, f"stability, {place}"].printed
    for place in ("(52)", "(56)", "(60)"):
        assert "-" not in rows[place, f"stability, {place}"].printed


def test_the_equilibrium_solves_the_balances(rows):
    """0.2 (5 - 5)/2 and 0.2 - 0.2; (16) by hand, of which (14) leaves f_in0 (dC_in - dC)."""
    assert rows["section 2.2", "static equilibrium"].computed == (
        "dC/dt = 0, dV/dt = 0; the start is there"
    )
    for key in (("(14)", "C_0"), ("(14)", "f_in0"), ("(16)", "dC/dt"), ("(16)", "dV/dt")):
        assert rows[key].verdict == "reproduced"


def test_the_headlines_are_claims_of_the_abstract_and_the_conclusions(audited):
    found = audited("averaging-tank").headlines
    assert 3 <= len(found) <= 6
    assert {row.place for row in found} == {"section 4", "section 5"}
    assert not {row.verdict for row in found} & {"reproduced", "misprint", "not reproducible"}


def test_no_printed_zero_stands_for_another_digit(rows):
    for place in ("(100b)", "(101b)"):
        assert rows[place, "F11 and Fi11"].printed == 0.0
    assert (rows["(100b)", "F22"].printed, rows["(100b)", "Fi22"].printed) == ("10^-6", "0.3298.0")
    assert {rows["(101b)", name].printed for name in ("F22", "Fi22")} == {"0.0885"}


def test_claims_fail_where_the_documents_own_figures_contradict_them(rows):
    assert keys(rows, "claim fails") == FAILING


def test_table_7_is_reproduced_but_where_it_was_solved_from_or_the_solver_decides(rows):
    cells = [row for row in rows.values() if row.place == "Table 7"]
    assert len(cells) == 40
    others = len(SOLVED_FROM) + len(OF_THE_SOLVER)
    assert sum(row.verdict == "reproduced" for row in cells) == 40 - others


def test_the_rest_is_as_printed(rows):
    rest = [row for row in rows.values() if row.is_counted and row.is_as_printed]
    assert {row.verdict for row in rest} == {"reproduced", "claim holds"} and len(rest) >= 200


def test_what_is_lower_in_table_7_is_counted_in_print_as_well(rows):
    """0.398 > 0.019 and so on; with either flow constant IE of C, optimal, is 0.019."""
    flow, tuning = (rows["section 4", f"LQI, {each}"] for each in ("which flow", "optimisation"))
    assert flow.computed.startswith("16 of 16 pairs computed and 15 of 16 printed")
    assert tuning.computed == "16 of 16 pairs computed and 16 printed"


def test_printed_denominators_of_pid_control_are_stable_for_the_same_signs():
    """T_i2 (1 + T_d1 K_p1) s² + T_i2 K_p2 s + K_p2 of (60) and (77), at the numbers of (77)."""
    poles = [np.roots([1.0 * (1.0 + 0.1 * 1.0), each, each]).real.max() for each in (1.0, -1.0)]
    assert poles[0] < 0.0 < poles[1]


def test_table_6_is_compared_in_all_its_cells(rows):
    """By the print: 1.242E-02 < 0.019, but not 8.80E-03; 1.170E-03 < 0.003, 1.42E-03; and so on."""
    words = rows["section 4", "PI against the others"].computed
    cells = ("ISE of C", "ISE of V", "IE of C", "IE of V")
    listed = ["IAE of C (LQI)", *(f"{cell} ({who})" for who in ("LQI", "fuzzy") for cell in cells)]
    assert words.startswith(f"Table 6 is lower in {', '.join(listed)}; optimal C settles, ")
    # 1.304E-02 > 0.011, 8.73E-03 and 1.997E-03 > 0.001, 5.15E-04: the worst of all three.
    worst = "it holds of IAE of V, ITAE of C, ITAE of V, and fails of the others"
    assert worst in rows["section 4", "PI against the others"].reason


def test_the_expanded_system_is_controllable_by_kalman(rows):
    """[B AB A²B A³B] of (92) with (93) and (95); A_roz has rank 2, and A of (32) rank 1."""
    A = np.zeros((4, 4))
    A[0, 0], A[2, 0], A[3, 1] = -0.1, 1.0, 1.0
    for sign in (1.0, -1.0):
        B = np.array([[0.0, 0.1], [sign, 0.0], [0.0, 0.0], [0.0, 0.0]])
        powers = [np.linalg.matrix_power(A, n) @ B for n in range(4)]
        assert np.linalg.matrix_rank(np.hstack(powers)) == 4
    row = rows["(94), (96)", "the expanded system"]
    assert row.verdict == "claim holds" and row.computed.count("rank 4 of 4") == 2
    assert (np.linalg.matrix_rank(A), np.linalg.matrix_rank(A[:2, :2])) == (2, 1)
