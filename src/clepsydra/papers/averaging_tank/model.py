"""Sections 2.1 and 2.2: the balances, their linear model, and the matrices at the equilibrium."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from sympy import Derivative, Function, Matrix, Rational, symbols

from clepsydra.linear.analysis import analyse
from clepsydra.papers.averaging_tank.symbols import Variant, matrix_rows, plant, s, u1, u3, x1, x2
from clepsydra.papers.comparison import claimed, compared, compared_formula, damaged, stated
from clepsydra.papers.experiment import Findings
from clepsydra.papers.row import Row
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

#: The documents' kmol/m³ in mol/m³.
KMOL = 1e3
_LOST = "One letter is lost."


def run() -> Findings:
    """Return the rows on the model."""
    return Findings((*_balances(), *_linear_model(), *_matrices()))


def tank(constant: Variant) -> Process:
    """Return the process with one flow constant.

    Examples
    --------
    >>> [signal.name for signal in tank("inflow").inputs]
    ['outflow', 'inflow.impurity']
    """
    return load_process(f"averaging-tank:{constant}-constant")


def high_tank(constant: Variant) -> Process:
    """Return the same process in a tank that holds the steps of `operating_range`.

    Examples
    --------
    >>> high_tank("outflow").signal("volume").high
    6.0
    """
    path = Path(__file__).with_name("high_tank.toml")
    return load_process(path, f"{constant}-constant")


def numbers(constant: Variant) -> tuple[np.ndarray, np.ndarray]:
    """Return A and B at the equilibrium, states C and V, C in kmol/m³.

    Examples
    --------
    >>> numbers("outflow")[0].round(6).tolist()
    [[-0.1, 0.0], [0.0, 0.0]]
    """
    model = analyse(tank(constant)).model
    order = [
        next(i for i, name in enumerate(model.states) if wanted in name)
        for wanted in ("impurity", "level")
    ]
    scale = np.array([KMOL, 1.0])
    A = model.A[np.ix_(order, order)] * scale / scale[:, None]
    B = model.B[order] * np.array([1.0, KMOL]) / scale[:, None]
    return A + 0.0, B + 0.0


def _balances() -> list[Row]:
    t = symbols("t")
    C, V = Function("C")(t), Function("V")(t)
    inflow, outflow, inlet = symbols("f_in f_out C_in")
    product = Derivative(V * C, t).doit()
    mixed = product.subs(Derivative(V, t), inflow - outflow)
    d_volume, d_concentration = symbols("dV(t) dC(t)")
    volume_balance = inflow - outflow
    solved = (inflow * inlet - outflow * C - volume_balance * C) / V
    return [
        damaged(
            compared_formula(
                "(3)", "left side", d_volume / t * C + V * Derivative(C, t), product,
                reason="Derivative of V C by the product rule: dV/dt, not dV/t.",
            ),
            _LOST,
        ),
        damaged(
            compared_formula(
                "(4)", "left side", (inflow - outflow) * C + V * d_concentration / t, mixed,
                reason="(3) with dV/dt from (1): dC/dt, not dC/t.",
            ),
            _LOST,
        ),
        compared_formula("(6)", "dC/dt", inflow / V * (inlet - C), solved, reason="(1) and (2)."),
        compared_formula("(10)", "f_V", inflow - outflow, volume_balance, reason="(1)."),
    ]  # fmt: skip


def _linear_model() -> list[Row]:
    inflow, outflow = symbols("f_in0 f_out0")
    time, gain = x2 / u1, 1 / u1
    outflow_constant, inflow_constant = plant("outflow"), plant("inflow")
    why = "(6) at the equilibrium with (14), in the names of (28)."
    rows = [
        stated(
            "(12)", "f_V at rest", "f_out0 - f_out0", str(inflow - outflow),
            outflow - outflow == inflow - outflow,
            "(10) at the equilibrium is f_in0 - f_out0.",
        ),
        compared_formula(
            "(17)", "C by f_in", gain * (u3 - x1) / (time * s + 1),
            outflow_constant.transfer[0, 0], reason=why,
        ),
        compared_formula(
            "(17)", "C by C_in", 1 / (time * s + 1), outflow_constant.transfer[0, 1], reason=why,
        ),
        compared_formula(
            "(17)", "V by f_in", 1 / s, outflow_constant.transfer[1, 0], reason=why
        ),
        compared_formula(
            "(17)", "V by f_out", -1 / s, inflow_constant.transfer[1, 0], reason=why
        ),
    ]  # fmt: skip
    A = Matrix([[-u1 / x2, 0], [0, 0]])
    why = (
        "Derivatives of (6) at the equilibrium: that of dC/dt by V is zero by (14), and dV/dt is "
        "f_in - f_out, with neither C nor V."
    )
    by_inputs = "Derivatives of (6) at the equilibrium: dV/dt is f_in - f_out, without C_in."
    for name, text, matrix, why_so in (
        ("A", "[-u10 0; x20 0; 0 0]", outflow_constant.A, why),
        ("B", "[u30-x10 u10; x20 x20; 1 0]", outflow_constant.B, by_inputs),
    ):
        right = str(matrix.tolist())
        rows.append(
            damaged(
                stated("(32)", name, text, right, text == right, why_so),
                "The bars of the fractions are lost: 3 × 2 stands there for 2 × 2.",
            )
        )  # fmt: skip
    rows += matrix_rows("(34)", "A", A, inflow_constant.A, why)
    by_inputs = "Derivatives of (6) at the equilibrium: dC/dt has no f_out, and dV/dt no C_in."
    rows += matrix_rows("(34)", "B", Matrix([[0, u1 / x2], [-1, 0]]), inflow_constant.B, by_inputs)
    why = (
        "(36) with the derivatives of (6), where that of dC/dt by V is zero by (14), and of (1), "
        "which has no C_in."
    )
    G = Matrix([[(u3 - x1) / (u1 + s * x2), u1 / (u1 + s * x2)], [1 / s, 0]])
    rows += matrix_rows("(45)", "Gp", G, outflow_constant.transfer, why)
    G = Matrix([[0, u1 / (u1 + s * x2)], [-1 / s, 0]])
    rows += matrix_rows("(63)", "Gp", G, inflow_constant.transfer, why)
    for place, variant, sign in (("(46)", outflow_constant, 1), ("(64)", inflow_constant, -1)):
        why = f"{'(45)' if sign > 0 else '(63)'} at (0.2, 0.2, 5, 5, 2)."
        here = {x1: 5, x2: 2, u1: Rational(1, 5), u3: 5}
        printed = Matrix([[0, 1 / (10 * s + 1)], [sign / s, 0]])
        rows += matrix_rows(place, "Gp at rest ", printed, variant.transfer.subs(here), why)
    return rows


def _matrices() -> list[Row]:
    """Compare what the process of the catalogue gives, not the symbols."""
    rows = []
    why = "Linear model of the process at (0.2, 0.2, 5, 5, 2)."
    for place, variant, text in (
        ("(93)", "outflow", (("0", "0.1"), ("1", "0"))),
        ("(95)", "inflow", (("0", "0.1"), ("-1", "0"))),
    ):
        _, B = numbers(variant)  # type: ignore[arg-type]
        rows += [
            compared(place, f"B{i + 1}{j + 1}", text[i][j], float(B[i, j]), digits=4, why=why)
            for i in range(2)
            for j in range(2)
        ]
    A, B = numbers("outflow")
    whole = np.block([[A, np.zeros((2, 2))], [np.eye(2), np.zeros((2, 2))]])
    printed = (("-0.1", "0", "0", "0"), ("0", "0", "0", "0"), ("1", "0", "0", "0"),
               ("0", "1", "0", "0"))  # fmt: skip
    rows += [
        compared(
            "(92)",
            f"A{i + 1}{j + 1}",
            printed[i][j],
            float(whole[i, j]),
            digits=4,
            why=why if i < 2 and j < 2 else "Blocks [A 0; C 0] of (88), C the identity.",
        )
        for i in range(4)
        for j in range(4)
    ]
    rows += _controllability()
    rows.append(
        stated(
            "(88)", "M", "[0 0 0; 0 0 0]", "[0 0; 0 0]", (2, B.shape[1]) == (2, 3),
            "M is the lower half of (93) and (95), which have two columns.",
        )
    )  # fmt: skip
    rows.append(
        damaged(
            stated(
                "(87)", "matrix before y_ref", "[0; 1]", "[0; I]",
                (len(whole), B.shape[1]) == (2, 1),
                "The extended state has four entries and y_ref two, so that it is 4 × 2.",
            ),
            "A bold I looks like a 1.",
        )
    )  # fmt: skip
    return rows


def _controllability() -> list[Row]:
    rows: list[Row] = []
    why = "[B AB] of (32)."
    spread = (u3 - x1) / x2
    printed = Matrix([[spread, u1 / x2, -u1 * (u3 - x1) / x2**2, u1**2 / x2**2], [1, 0, 0, 0]])
    found = plant("outflow")
    rows += [
        damaged(row, "A minus sign is lost, which the same entry of (96) has.")
        for row in matrix_rows(
            "(94)", "M", printed, Matrix.hstack(found.B, found.A * found.B), why
        )
    ]  # fmt: skip
    printed = Matrix([[0, u1 / x2, 0, -(u1**2) / x2**2], [-1, 0, 0, 0]])
    found = plant("inflow")
    why = "[B AB] of (34)."
    rows += matrix_rows("(96)", "M", printed, Matrix.hstack(found.B, found.A * found.B), why)
    A, _ = numbers("outflow")
    rank = int(np.linalg.matrix_rank(A))
    flat = (
        "A of (32) and (34), the primary system of the sentence, has a row of zeros",
        not A[1].any(),
    )
    rows.append(compared("(94), (96)", "rank of A", "2", float(rank), right_if=[flat]))
    for place, variant in (("(94)", "outflow"), ("(96)", "inflow")):
        A, B = numbers(variant)  # type: ignore[arg-type]
        rank = int(np.linalg.matrix_rank(np.hstack([B, A @ B])))
        rows.append(
            compared(place, "rank of M", "2", float(rank), why=f"{place} at (0.2, 0.2, 5, 5, 2).")
        )
        whole = np.block([[A, B], [np.eye(2), np.zeros((2, 2))]])
        full = int(np.linalg.matrix_rank(whole))
        rows.append(
            claimed(
                place, "the extended system", "the expanded system is controllable", full == 4,
                f"rank {full} of 4",
                reason="Rank of [A B; C 0], beside the rank of M.",
            )
        )  # fmt: skip
    return rows
