"""Table 1 and equations (2) to (4): what the printed parameters give."""

from __future__ import annotations

import numpy as np
import pint

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.comparison import claimed, compared, damaged, stated
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.papers.three_tanks.printed_model import (
    DENOMINATOR,
    FLOW,
    IN_FULL,
    LEVELS,
    NUMERATOR,
    flows_at,
    linear_model_at,
    printed_model,
    three_tanks,
)

_A = (("-0.0322", "0.0322", "0"), ("0.0322", "-0.0578", "0.0257"), ("0", "0.0257", "-0.0371"))
_B = ("64.93", "0", "0")
#: A and B of (2) in letters; where one is zero, what the balance of that tank does not have.
_LETTERS = (
    ("-k1/A", "k1/A", "h3", "1/A"),
    ("k1/A", "-(k2 + k1)/A", "k2/A", "q1"),
    ("h1", "k2/A", "-(k2 + k3)/A", "q1"),
)
#: Of the controllability matrix, where no rounding of (2) matters.
_ORIGINS = {
    (0, 0): "1/A, which (2) cuts to 64.93.",
    (1, 0): "B2 of (2).",
    (2, 0): "B3 of (2).",
    (2, 1): "Third row of A times B: A31, B2 and B3 are zero.",
}
_Q = (("64.94", "-2.6", "0.17"), ("0", "2.1", "-0.2"), ("0", "0", "0.05"))


def run() -> Findings:
    """Return the rows on the model, and the open-loop response."""
    rows = (*_units(), *_rest(), *_matrices(), *_transfer_function(), *_controllability())
    return Findings(rows, (_open_loop(),))


def _units() -> list[Row]:
    """Judge the units of table 1 by the equations that use them."""
    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    speed = (registry("m^2/s") * registry("m")).dimensionality
    is_speed = speed == (registry("m/s") ** 2).dimensionality
    metres = printed_model().A
    second = linear_model_at(np.array([0.5, 0.0045, 0.4])).A
    third = linear_model_at(np.array([0.5, 0.45, 0.004])).A
    return [
        damaged(
            stated(
                "Table 1", "unit of g", "m²/s", "m/s²", is_speed,
                "The root of 2 g h is a speed only where g is an acceleration.",
            ),
            "The exponent stands at the metre and not at the second.",
        ),
        stated(
            "Table 1", "unit of h2s", "cm", "m", abs(second[0, 1] - 0.0322) < 5e-5,
            f"With h2s = 0.45 cm the first rate of (2) is {second[0, 1]:.4f} 1/s, "
            f"with 0.45 m {metres[0, 1]:.4f}, as printed.",
        ),
        stated(
            "Table 1", "unit of h3s", "cm", "m",
            abs(third[1, 2] - 0.0257) < 5e-5 and abs(third[2, 2] + 0.0371) < 5e-5,
            f"With h3s = 0.4 cm, h2s in metres, A23 and A33 of (2) are {third[1, 2]:.4f} and "
            f"{third[2, 2]:.4f} 1/s, with 0.4 m {metres[1, 2]:.4f} and {metres[2, 2]:.4f}, as "
            "printed.",
        ),
    ]  # fmt: skip


def _rest() -> list[Row]:
    flows = 1e6 * flows_at(LEVELS)
    shown = ", ".join(f"{flow:.1f}" for flow in flows)
    return [
        compared(
            "Table 1", "q2s at 0.40 m in tank 3", "50", float(flows[2]), "cm³/s",
            unprinted="Flows in series are one flow at rest, but the levels of Table 1, read in "
            f"metres as (2) needs them, and its coefficients make q12, q23 and q2 {shown} cm³/s; "
            "nothing tells which is wrong.",
        ),
    ]  # fmt: skip


def _matrices() -> list[Row]:
    model = printed_model()
    rows = [
        compared(
            "(2)", f"A{i + 1}{j + 1}", _A[i][j], float(model.A[i, j]), "1/s", why=_origin(i, j)
        )
        for i in range(3)
        for j in range(3)
    ]
    rows += [
        compared("(2)", f"B{i + 1}", _B[i], float(model.B[i, 0]), "1/m²", why=_origin(i, 3))
        for i in range(3)
    ]
    eigenvalues = np.linalg.eigvals(model.A)
    rows.append(
        claimed(
            "simulation results", "open loop", "the open loop system is stable",
            bool(np.all(eigenvalues < 0.0)),
            ", ".join(f"{value:.4f}" for value in sorted(eigenvalues.real)), "1/s",
            reason="Eigenvalues of A in letters with Table 1, levels in metres, unrounded.",
        )
    )  # fmt: skip
    return rows


def _origin(row: int, column: int) -> str:
    """Say what an entry of [A B] of (2) comes from, both numbers from zero."""
    letters = _LETTERS[row][column]
    if letters.endswith("/A"):
        return f"{letters} with Table 1{', levels in metres' if 'k' in letters else ''}."
    return f"The balance of tank {row + 1} in (1) has no {letters}."


def _transfer_function() -> list[Row]:
    model = printed_model()
    polynomial = np.poly(model.A)
    numerator = float(model.B[0, 0] * model.A[1, 0] * model.A[2, 1])
    why = f"From {IN_FULL}."
    # Half a unit of each of the three rates whose sum it is.
    left = 3 * 5e-5
    rows = [
        compared("(3)", "numerator", "0.054", numerator, "1/(m² s²)", why=why),
        compared(
            "(3)", "coefficient of s²", "0.1272", float(polynomial[1]), "1/s",
            tolerance=left / float(polynomial[1]),
            why=f"{why} Minus the sum of the diagonal of A, whose four decimals in (2) leave "
            f"{left:g} open.",
        ),
        compared("(3)", "coefficient of s", "0.0035", float(polynomial[2]), "1/s²", why=why),
        compared("(3)", "constant coefficient", "9.4E-6", float(polynomial[3]), "1/s³", why=why),
    ]  # fmt: skip
    # Of the companion form x1 = h3, x2 = dh3/dt, x3 = d²h3/dt² of (3).
    printed = ("-9.4E-6", "-0.0035", "-0.127")
    rows += [
        compared("(4)", f"A3{j + 1}", printed[j], -float(polynomial[3 - j]), unit, why=why)
        for j, unit in enumerate(("1/s³", "1/s²", "1/s"))
    ]
    gain = NUMERATOR / DENOMINATOR[3]
    rest = np.linalg.solve(_companion(), -np.array([0.0, 0.0, 1.0]))
    evidence = (
        f"with it the static gain to x1, the level of tank 3, is the {gain:.4g} s/m² of (3), and "
        f"with B3 = 1 {rest[0]:.4g}",
        abs(rest[0] / gain - 1.0) > 0.5,
    )
    rows.append(compared("(4)", "B3", "1", NUMERATOR, "1/(m² s²)", right_if=[evidence]))
    rows.append(
        stated(
            "(4)", "output", "y = [0 0 1] x", "y = [1 0 0] x", bool(abs(rest[2]) > 1e-9),
            "x1 is the level of tank 3 by its definition, and x3 is zero at rest.",
        )
    )  # fmt: skip
    return rows


def _companion() -> np.ndarray:
    matrix = np.diag([1.0, 1.0], 1)
    matrix[2] = -DENOMINATOR[:0:-1]
    return matrix


def _controllability() -> list[Row]:
    model = printed_model()
    matrix = np.hstack([model.B, model.A @ model.B, model.A @ model.A @ model.B])
    by_print = 64.94 * np.array(_A, dtype=float)[:, 0]
    evidence = [
        (
            "its column sums to zero, as tank 1 gives tank 2 what it loses, and has 2.1",
            abs(by_print[0] + by_print[1]) < 1e-9 and round(by_print[1], 1) == 2.1,
        )
    ]
    squared = np.array(_A, dtype=float) @ by_print
    second = [
        (
            f"the A of (2) and 64.94 of Qc give {squared[0]:.4f}",
            round(squared[0], 2) == 0.13 and round(by_print[0], 1) == -2.1,
        )
    ]
    # Both entries follow from one wrong rate, so that neither is a digit lost on the way to us.
    other = -0.04 * 64.94, 0.04**2 * 64.94 + 0.0322 * by_print[1]
    one_slip = (
        "-0.04 for the -0.0322 of (2) makes Qc12 and Qc13 as printed",
        round(other[0], 1) == -2.6 and round(other[1], 2) == 0.17,
    )
    proof = {(0, 1): [*evidence, one_slip], (0, 2): [*second, one_slip]}
    rows = [
        compared(
            "controllability", f"Qc{i + 1}{j + 1}", _Q[i][j], float(matrix[i, j]),
            why=_ORIGINS.get((i, j), f"From {IN_FULL}."),
            right_if=proof.get((i, j), ()),
        )
        for i in range(3)
        for j in range(3)
    ]  # fmt: skip
    rows.append(
        claimed(
            "controllability", "rank", "the system under consideration is controllable",
            np.linalg.matrix_rank(matrix) == 3, f"rank {np.linalg.matrix_rank(matrix)}",
            reason="Rank of B, AB, A²B.",
        )
    )  # fmt: skip
    return rows


def _open_loop() -> Figure:
    """Redraw Fig. 4: all levels after a step of the feed of a tenth, linear and nonlinear."""
    from scipy.integrate import solve_ivp

    process = three_tanks()
    start = find_equilibrium(process).state
    time = np.linspace(0.0, 3000.0, 600)
    flow, load = 1.1 * FLOW, np.zeros(len(process.disturbances))
    model = linear_model_at(start)
    tanks = solve_ivp(
        lambda t, x: np.array(process.dynamics(x, flow, load, process.parameter_values)).ravel(),
        (0.0, time[-1]), start, t_eval=time, rtol=1e-8, method="LSODA",
    ).y  # fmt: skip
    linear = solve_ivp(
        lambda t, x: model.A @ x + model.B[:, 0] * (flow - FLOW),
        (0.0, time[-1]), np.zeros(3), t_eval=time, rtol=1e-8, method="LSODA",
    ).y  # fmt: skip
    panels = tuple(
        Panel(
            f"tank {i + 1}", "level [cm]",
            (
                Curve("orifice laws", time, 100.0 * tanks[i]),
                Curve("linear model", time, 100.0 * (linear[i] + start[i]), "dashed"),
            ),
        )
        for i in range(3)
    )  # fmt: skip
    return Figure(
        "Fig. 4", "Levels after a rise of the feed by a tenth, from rest at 50 cm³/s", panels
    )
