"""What is printed wrongly is found by computation; the lists here are written by hand."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from clepsydra.papers.averaging_tank.lqi import COLUMNS, gains, lqi_run
from clepsydra.papers.averaging_tank.model import numbers
from clepsydra.papers.averaging_tank.pi import BY_HAND, pi_run
from clepsydra.papers.averaging_tank.step_run import indices

pytestmark = pytest.mark.thorough

MISPRINTS = {
    ("(3)", "left side"),
    ("(4)", "left side"),
    ("(12)", "f_V at rest"),
    ("(37)", "K"),
    ("(56)", "GCL11"),
    ("(56)", "GCL22"),
    ("(59)", "Gc21"),
    ("(60)", "GCL22"),
    ("(76)", "Gc21"),
    ("(77)", "GCL22"),
    ("(87)", "matrix before y_ref"),
    ("(88)", "M"),
    ("(94)", "M14"),
    ("(97b)", "Fi12"),
    ("(100b)", "F21"),
    ("(100b)", "Fi21"),
    ("(101a)", "Q3"),
    ("(101b)", "F21"),
    ("(101b)", "Fi21"),
    ("Table 6", "IE of C, f_in constant, optimal"),
}
RIGHT = {
    ("(97b)", "Fi12"): 10**0.5,
    ("(100b)", "F21"): 262.4,
    ("(101a)", "Q3"): 10.92,
    ("(101b)", "F21"): 256.1,
    ("Table 6", "IE of C, f_in constant, optimal"): 3.106e-6,
}
FAILING = {
    ("(69)", "stability, (69)"),
    ("(100a)", "optimal weights"),
    ("section 3.1.3", "PI, what IE chooses"),
    ("section 3.3", "limits of C_in"),
    ("section 4", "PI, wind-up with f_out constant"),
    ("section 4", "PI, f_in with f_out constant"),
    ("section 4", "PI against the others"),
    *(
        ("section 3.1.3", f"best type by {index}, {flow} constant")
        for index in ("IAE", "ISE", "ITAE")
        for flow in ("f_out", "f_in")
    ),
}
EXPERIMENTS = {"model", "closed-loops", "pi", "pid-types", "lqi"}


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


def test_of_table_6_only_the_signed_error_can_be_reproduced(rows):
    cells = {
        key for key in rows if key[0] == "Table 6" and key[1].split()[0] in ("IAE", "ISE", "ITAE")
    }
    assert len(cells) == 12 and all(rows[key].verdict == "not reproducible" for key in cells)
    assert keys(rows, "not reproducible") == cells | {
        ("Table 6", f"IE of V, f_{flow} constant, optimal") for flow in ("out", "in")
    }
    tuned = {key for key in rows if key[1].startswith("optimum of")}
    assert len(tuned) == 6 and all(rows[key].verdict == "claim fails" for key in tuned)


def test_claims_fail_where_the_documents_own_figures_contradict_them(rows):
    tuned = {key for key in rows if key[1].startswith("optimum of")}
    assert keys(rows, "claim fails") == FAILING | tuned


def test_every_cell_of_table_7_is_reproduced(rows):
    cells = [row for row in rows.values() if row.place == "Table 7"]
    assert len(cells) == 40 and {row.verdict for row in cells} == {"reproduced"}


def test_the_rest_is_as_printed(rows):
    rest = {row.verdict for row in rows.values()} - {"misprint", "not reproducible", "claim fails"}
    assert rest == {"reproduced", "claim holds"} and len(rows) >= 270


def continuous(slope, horizon, size):
    """IE, IAE, ISE and ITAE of C and V by an independent solver, beside the states."""

    def with_errors(t, x):
        rates, errors = slope(t, x[:size])
        more = [f(e) for e in errors for f in (lambda e: e, abs, np.square)]
        return [*rates, *more, *(t * abs(e) for e in errors)]

    start = np.zeros(size + 8)
    start[:2] = 5.0, 2.0
    end = solve_ivp(with_errors, (0, horizon), start, method="LSODA", rtol=1e-9, atol=1e-12).y[
        size:, -1
    ]
    names = [(i, o) for o in ("C", "V") for i in ("IE", "IAE", "ISE")]
    return dict(zip([*names, ("ITAE", "C"), ("ITAE", "V")], end, strict=True))


@pytest.mark.parametrize("column", [COLUMNS[0], COLUMNS[2]], ids=lambda c: c.title)
def test_table_7_by_another_solver_in_continuous_time(column):
    F = gains(column)

    def slope(t, x):
        C, V, *integrals = x
        deviation = np.array([C - 5.0, V - 2.0, *integrals])
        flow, inlet = -F @ deviation
        inflow, outflow = (0.2 + flow, 0.2) if column.constant == "outflow" else (0.2, 0.2 + flow)
        inflow, outflow = np.clip([inflow, outflow], 0.0, 1.0)
        errors = 5.25 - C, 2.1 - V
        rates = inflow / V * (np.clip(5.0 + inlet, 0, 25) - C), inflow - outflow
        return (*rates, -errors[0], -errors[1]), errors

    found = continuous(slope, 30.0, 4)
    ours = indices(lqi_run(column))
    for key, value in found.items():
        assert ours[key] == pytest.approx(value, rel=2e-3), key


def test_pi_control_by_another_solver_in_continuous_time():
    constants = BY_HAND["outflow"]

    def slope(t, x):
        C, V, of_c, of_v = x
        errors = 5.25 - C, 2.1 - V
        inlet = 5.0 + constants.gain_c * (errors[0] + of_c / constants.time_c)
        inflow = 0.2 + constants.gain_v * (errors[1] + of_v / constants.time_v)
        inflow, inlet = np.clip(inflow, 0, 1), np.clip(inlet, 0, 25)
        return (inflow / V * (inlet - C), inflow - 0.2, *errors), errors

    found = continuous(slope, 30.0, 4)
    ours = indices(pi_run(constants))
    for index in ("IAE", "ISE", "ITAE"):
        for output in ("C", "V"):
            assert ours[index, output] == pytest.approx(found[index, output], rel=5e-3)


@pytest.mark.parametrize("column", COLUMNS, ids=lambda c: c.title)
def test_the_gains_solve_the_riccati_equation(column):
    """By the stable invariant subspace of the Hamiltonian, without a solver of the equation."""
    A, B = numbers(column.constant)
    A = np.block([[A, np.zeros((2, 2))], [np.eye(2), np.zeros((2, 2))]])
    B = np.vstack([B, np.zeros((2, 2))])
    R = np.diag(column.inputs)
    H = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-np.diag(column.states), -A.T]])
    values, vectors = np.linalg.eig(H)
    stable = vectors[:, values.real < 0]
    P = np.real(stable[4:] @ np.linalg.inv(stable[:4]))
    assert gains(column) == pytest.approx(np.linalg.solve(R, B.T @ P), rel=1e-6, abs=1e-5)
