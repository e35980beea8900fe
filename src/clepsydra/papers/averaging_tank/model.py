"""Sections 2.1 and 2.2: the balances, their linear model, and the matrices at the equilibrium."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from clepsydra.linear.analysis import analyse
from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.symbols import AT_REST, Variant, balances, plant
from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import with_values
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import exact, symbol, symbols
from clepsydra.papers.row import Row, Rows
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

#: The documents' kmol/m³ in mol/m³.
KMOL = 1e3
#: As the balances of section 2.1 write them.
_C, _V = symbols("C(t) V(t)")


def run() -> Found:
    """Return the rows on the model."""
    return (
        *_balances(), _unit(), *_at_rest(), _equilibrium(), _evaporation(), *_linear_model(),
        *_matrices(),
    )  # fmt: skip


@cache
def tank(constant: Variant) -> Process:
    """Return the process with one flow constant."""
    return load_process(f"averaging-tank:{constant}-constant")


@cache
def high_tank(variant: str) -> Process:
    """Return a variant of the process in a tank that holds the steps of `operating_range`."""
    path = Path(__file__).with_name("high_tank.toml")
    return load_process(path, variant)


@cache
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
    inflow, outflow, inlet = symbols("f_in f_out C_in")
    dC, dV = (symbol(f"Derivative({each}, t)") for each in (_C, _V))
    product = (_V * _C).derivative(str(_C)) * dC + (_V * _C).derivative(str(_V)) * dV
    volume_balance = inflow - outflow
    mixed = product.with_values({str(dV): volume_balance})
    transformed = inflow * inlet - outflow * _C - volume_balance * _C
    solved = transformed / _V
    for place, name, found in (
        ("(3)", "left side", product), ("(4)", "left side", mixed),
        ("(5)", "right side", transformed), ("(6)", "dC/dt", solved),
        ("(6)", "dV/dt", volume_balance), ("(9)", "f_C", solved), ("(10)", "f_V", volume_balance),
    ):  # fmt: skip
        yield PRINTED[place, name].formula(found)


def _unit() -> Row:
    """Judge the unit in Table 1: the balance of C holds in either."""
    C, inlet, factor = symbols("C C_in k")
    rate = balances()[0]
    scaled = rate.with_values({"C": factor * C, "C_in": factor * inlet})
    holds = "holds in both" if scaled == factor * rate else "does not hold in both"
    return PRINTED["Table 1", "unit of C_in and C"].remark(
        f"kmol/m³ in sections 2.2 and 3.3; (6) {holds}"
    )


def _at_rest() -> Rows:
    """Put the equilibrium into (9) and (10), solve for it, and differentiate there."""
    *_, inlet, _, V = rest = symbols("f_in0 f_out0 C_in0 C_0 V_0")
    names = ("f_in", "f_out", "C_in", "C", "V")
    at_rest = dict(zip(names, rest, strict=True))
    of_c, of_v = (rate.with_values(at_rest) for rate in balances())
    yield PRINTED["(11)", "f_C at rest"].formula(of_c)
    yield PRINTED["(12)", "f_V at rest"].formula(of_v)
    yield from PRINTED.formulas("(13)", {"first line": of_c, "second line": of_v})
    yield from PRINTED.formulas("(14)", {"C_0": of_c.root("C_0"), "f_in0": of_v.root("f_in0")})
    moved = dict(zip(names, symbols("df_in df_out dC_in dC dV"), strict=True))
    # C0 = C_in0, (14), takes away what V does to dC/dt, as the document has it.
    slopes = [
        {name: rate.derivative(name).with_values(at_rest) for name in names} for rate in balances()
    ]
    slopes[0]["V"] = slopes[0]["V"].with_values({"C_0": inlet})
    linear = [sum((slope[name] * moved[name] for name in names), exact(0)) for slope in slopes]
    yield from PRINTED.formulas("(16)", {"dC/dt": V * linear[0], "dV/dt": linear[1]})


def _equilibrium() -> Row:
    """Judge that the operating point is one, and that the runs begin there."""
    point = PRINTED.numbers("section 2.2", "f_in0", "f_out0", "C_in0", "C0", "V0")
    inflow, outflow, inlet, C, V = point
    rates = inflow / V * (inlet - C), inflow - outflow
    start = PRINTED.numbers("section 2.2", "C_p", "V_p")
    is_there = "is" if start == [C, V] else "is not"
    return PRINTED["section 2.2", "static equilibrium"].claimed(
        not any(rates), f"dC/dt = {rates[0]:g}, dV/dt = {rates[1]:g}; the start {is_there} there"
    )


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
    outflow_constant, inflow_constant = plant("outflow"), plant("inflow")
    by = outflow_constant.transfer
    transfer = {
        "C by f_in": by[0, 0], "C by C_in": by[0, 1], "V by f_in": by[1, 0],
        "V by f_out": inflow_constant.transfer[1, 0],
    }  # fmt: skip
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
    yield PRINTED["(88)", "M"].stated("[0 0; 0 0]", (2, B.shape[1]) == (2, 3))
    yield input_matrix.stated("[0; I]", (len(whole), B.shape[1]) == (2, 1))
