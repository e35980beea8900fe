"""Table 1 and equations (2) to (4): what the printed parameters give."""

from __future__ import annotations

import numpy as np
import pint

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.papers.comparison import claimed, compared, stated
from clepsydra.papers.experiment import Findings
from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.papers.row import Row
from clepsydra.papers.three_tanks.printed_model import (
    DENOMINATOR,
    FLOW,
    LEVELS,
    NUMERATOR,
    flows_at,
    linear_model_at,
    printed_model,
    three_tanks,
)

_A = (("-0.0322", "0.0322", "0"), ("0.0322", "-0.0578", "0.0257"), ("0", "0.0257", "-0.0371"))
_B = ("64.93", "0", "0")
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
    in_centimetres = linear_model_at(np.array([0.5, 0.0045, 0.004])).A[0, 1]
    reason = (
        f"With centimetres the first rate of (2) is {in_centimetres:.4f} 1/s, "
        f"with metres {printed_model().A[0, 1]:.4f}; 0.0322 is printed."
    )
    is_centimetre = abs(in_centimetres - 0.0322) < 5e-5
    return [
        stated(
            "Table 1", "unit of g", "m²/s", "m/s²", is_speed,
            "The root of 2 g h is a speed only where g is an acceleration.",
        ),
        *(
            stated("Table 1", f"unit of {name}", "cm", "m", is_centimetre, reason)
            for name in ("h2s", "h3s")
        ),
    ]  # fmt: skip


def _rest() -> list[Row]:
    flows = 1e6 * flows_at(LEVELS)
    names = ("q12", "q23", "q2")
    rows = [
        compared(
            "Table 1", f"{name} at the printed levels", "50", flow, "cm³/s",
            why="From the orifice laws with the printed coefficients.",
            unprinted="The printed levels and coefficients contradict each other; C2 = 1.0096 and "
            "C3 = 0.35696 would make them agree, but (2) uses the printed ones.",
        )
        for name, flow in zip(names, flows.tolist(), strict=True)
    ]  # fmt: skip
    level_1, level_2, level_3 = find_equilibrium(three_tanks()).state.tolist()
    rows.append(
        claimed(
            "Table 1", "rest", "50 cm³/s keeps 0.5, 0.45 and 0.4 m",
            bool(np.allclose((level_1, level_2, level_3), LEVELS, atol=5e-3)),
            f"{level_1:.4f}, {level_2:.4f}, {level_3:.4f} m",
            reason="The levels at which the printed coefficients pass 50 cm³/s.",
        )
    )  # fmt: skip
    return rows


def _matrices() -> list[Row]:
    model = printed_model()
    why = "Slope of the orifice laws at the printed levels."
    rows = [
        compared("(2)", f"A{i + 1}{j + 1}", _A[i][j], float(model.A[i, j]), "1/s", why=why)
        for i in range(3)
        for j in range(3)
    ]
    rows += [
        compared("(2)", f"B{i + 1}", _B[i], float(model.B[i, 0]), "1/m²", why="1/A.")
        for i in range(3)
    ]
    eigenvalues = np.linalg.eigvals(model.A)
    rows.append(
        claimed(
            "Simulation results", "open loop", "the open loop is stable",
            bool(np.all(eigenvalues < 0.0)),
            ", ".join(f"{value:.4f}" for value in sorted(eigenvalues.real)), "1/s",
            reason="Eigenvalues of (2).",
        )
    )  # fmt: skip
    return rows


def _transfer_function() -> list[Row]:
    model = printed_model()
    polynomial = np.poly(model.A)
    numerator = float(model.B[0, 0] * model.A[1, 0] * model.A[2, 1])
    why = "From the exact constants of (2)."
    cut = (
        "(2) gives 0.1271, and so does the sum of its printed diagonal",
        round(-float(np.trace(np.array(_A, dtype=float))), 4) == 0.1271,
    )
    rows = [
        compared("(3)", "numerator", "0.054", numerator, "1/(m² s²)", why=why),
        compared(
            "(3)", "coefficient of s²", "0.1272", float(polynomial[1]), "1/s",
            why=why, right_if=[cut],
        ),
        compared("(3)", "coefficient of s", "0.0035", float(polynomial[2]), "1/s²", why=why),
        compared("(3)", "constant coefficient", "9.4E-6", float(polynomial[3]), "1/s³", why=why),
    ]  # fmt: skip
    # Of the companion form x1 = h3, x2 = dh3/dt, x3 = d²h3/dt² of (3).
    printed = ("-9.4E-6", "-0.0035", "-0.127")
    rows += [
        compared("(4)", f"A3{j + 1}", printed[j], -float(DENOMINATOR[3 - j]), f"1/s^{3 - j}")
        for j in range(3)
    ]
    gain = NUMERATOR / DENOMINATOR[3]
    rest = np.linalg.solve(_companion(), -np.array([0.0, 0.0, 1.0]))
    evidence = (
        f"with B3 = 1 the static gain would be {rest[0]:.4g} instead of the "
        f"{gain:.4g} s/m² of (3), and x3 is driven by 0.054 u in the line above (4)",
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
            "tank 1 gives tank 2 what it loses, so that the column sums to zero, and 2.1 below it "
            "is right",
            abs(by_print[0] + by_print[1]) < 1e-9 and round(by_print[1], 1) == 2.1,
        )
    ]
    squared = np.array(_A, dtype=float) @ by_print
    second = [
        (
            f"the printed A and B give {squared[0]:.4f}, and the -0.2 and 0.05 below it",
            round(squared[0], 2) == 0.13 and round(squared[1], 1) == -0.2,
        )
    ]
    proof = {(0, 1): evidence, (0, 2): second}
    rows = [
        compared(
            "controllability", f"Qc{i + 1}{j + 1}", _Q[i][j], float(matrix[i, j]),
            why="From (2).", right_if=proof.get((i, j), ()),
        )
        for i in range(3)
        for j in range(3)
    ]  # fmt: skip
    rows.append(
        claimed(
            "controllability", "rank", "the system is controllable",
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
