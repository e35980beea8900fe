"""Sections 2.1 and 2.2: the balances, their linear model, and the matrices at the equilibrium."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clepsydra.linear.analysis import analyse
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.symbols import AT_REST, VARIANTS, Variant, plant
from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import with_values
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import symbol, symbols
from clepsydra.papers.row import Row, Rows
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

#: The documents' kmol/m³ in mol/m³.
KMOL = 1e3


def run() -> Found:
    """Return the rows on the model."""
    return (*_balances(), _evaporation(), *_linear_model(), *_matrices())


def tank(constant: Variant) -> Process:
    """Return the process with one flow constant."""
    return load_process(f"averaging-tank:{constant}-constant")


def high_tank(variant: str) -> Process:
    """Return a variant of the process in a tank that holds the steps of `operating_range`."""
    path = Path(__file__).with_name("high_tank.toml")
    return load_process(path, variant)


def numbers(constant: Variant) -> tuple[np.ndarray, np.ndarray]:
    """Return A and B at the equilibrium, states C and V, C in kmol/m³."""
    model = analyse(tank(constant)).model
    order = [
        next(i for i, name in enumerate(model.states) if wanted in name)
        for wanted in ("impurity", "level")
    ]
    scale = np.array([KMOL, 1.0])
    A = model.A[np.ix_(order, order)] * scale / scale[:, None]
    B = model.B[order] * np.array([1.0, KMOL]) / scale[:, None]
    return A + 0.0, B + 0.0


def _balances() -> Rows:
    C, V, inflow, outflow, inlet = symbols("C(t) V(t) f_in f_out C_in")
    dC, dV = (symbol(f"Derivative({each}, t)") for each in (C, V))
    product = (V * C).derivative(str(C)) * dC + (V * C).derivative(str(V)) * dV
    volume_balance = inflow - outflow
    mixed = product.with_values({str(dV): volume_balance})
    solved = (inflow * inlet - outflow * C - volume_balance * C) / V
    for place, name, found in (
        ("(3)", "left side", product), ("(4)", "left side", mixed), ("(6)", "dC/dt", solved),
        ("(10)", "f_V", volume_balance),
    ):  # fmt: skip
        yield PRINTED[place, name].formula(found)


def _evaporation() -> Row:
    """Let z [m³/s] leave the volume (1), and nothing dissolved with it the amount (2)."""
    C, V, inflow, outflow, inlet, z = symbols("C V f_in f_out C_in z")
    of_volume = inflow - outflow - z
    of_concentration = (inflow * inlet - outflow * C - of_volume * C) / V
    at_rest = dict(zip("CV", symbols("C_0 V_0"), strict=True))
    volume, concentration = (
        z * rate.derivative("z").with_values(at_rest) for rate in (of_volume, of_concentration)
    )
    return PRINTED["section 3.1", "evaporation z(t)"].claimed(
        volume.derivative("z") != 0, f"dV/dt by {volume}, dC/dt by {concentration}"
    )


def _linear_model() -> Rows:
    inflow, outflow = symbols("f_in0 f_out0")
    outflow_constant, inflow_constant = plant("outflow"), plant("inflow")
    by = outflow_constant.transfer
    transfer = {
        "C by f_in": by[0, 0], "C by C_in": by[0, 1], "V by f_in": by[1, 0],
        "V by f_out": inflow_constant.transfer[1, 0],
    }  # fmt: skip
    yield PRINTED["(12)", "f_V at rest"].stated(
        str(inflow - outflow), outflow - outflow == inflow - outflow
    )
    yield from PRINTED.formulas("(17)", transfer)
    for name, matrix in (("A", outflow_constant.A), ("B", outflow_constant.B)):
        line, right = PRINTED["(32)", name], str(matrix.tolist())
        yield line.stated(right, line.text == right)
    for place, found in (
        ("(34)", entries("A", inflow_constant.A) | entries("B", inflow_constant.B)),
        ("(45)", entries("Gp", by)),
        ("(63)", entries("Gp", inflow_constant.transfer)),
        ("(46)", entries("Gp at rest ", with_values(by, AT_REST))),
        ("(64)", entries("Gp at rest ", with_values(inflow_constant.transfer, AT_REST))),
    ):
        yield from PRINTED.formulas(place, found)


def _matrices() -> Rows:
    """Compare what the process of the catalogue gives, not the symbols."""
    A, B = numbers("outflow")
    whole = np.block([[A, np.zeros((2, 2))], [np.eye(2), np.zeros((2, 2))]])
    input_matrix = PRINTED["(87)", "matrix before y_ref"]
    yield from PRINTED.compared("(93)", entries("B", B))
    yield from PRINTED.compared("(95)", entries("B", numbers("inflow")[1]))
    yield from PRINTED.compared("(92)", entries("A", whole))
    yield from _controllability()
    yield PRINTED["(88)", "M"].stated("[0 0; 0 0]", (2, B.shape[1]) == (2, 3))
    yield input_matrix.stated("[0; I]", (len(whole), B.shape[1]) == (2, 1))


def _controllability() -> Rows:
    variants = tuple(zip(("(94)", "(96)"), VARIANTS, strict=True))
    for place, variant in variants:
        found = plant(variant)
        matrix = np.hstack([found.B, found.A @ found.B])
        yield from PRINTED.formulas(place, entries("M", matrix))
    A, _ = numbers("outflow")
    flat = (
        "A of (32) and (34), the primary system of the sentence, has a row of zeros",
        not A[1].any(),
    )
    rank = float(np.linalg.matrix_rank(A))
    yield PRINTED["(94), (96)", "rank of A"].compared(rank, right_if=[flat])
    for place, variant in variants:
        A, B = numbers(variant)
        yield from PRINTED.compared(
            place, {"rank of M": np.linalg.matrix_rank(np.hstack([B, A @ B]))}
        )
        whole = np.block([[A, B], [np.eye(2), np.zeros((2, 2))]])
        full = int(np.linalg.matrix_rank(whole))
        line = PRINTED[place, "the extended system"]
        yield line.claimed(full == 4, f"rank {full} of 4")
