"""Sections 2 and 3 in symbols: balances, Lie derivatives, decoupling and what (10) leaves.

What is computed comes from the equations of the process that is simulated, and from the Lie
derivatives that the controller is made of, turned into exact expressions.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from clepsydra.linear.relative_degree import VectorRelativeDegree, relative_degree
from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import determinant, diagonal, inverse, jacobian, matrix
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.rig import at_target
from clepsydra.papers.four_tank_variable_structure.symbolic import exactly
from clepsydra.papers.printed_table import entries
from clepsydra.papers.rational_function import RationalFunction, exact, square_root, symbols
from clepsydra.papers.row import Row, Rows


class Derived:
    """The symbols of the document, and what the program's equations are in them."""

    def __init__(self) -> None:
        (self.g,) = symbols("g")
        self.A = symbols("A1 A2 A3 A4")
        self.a = symbols("a1 a2 a3 a4")
        self.h = symbols("h1 h2 h3 h4")
        self.gamma = symbols("gamma1 gamma2")
        self.k = symbols("k1 k2")
        self.v = symbols("v1 v2")
        self.linearised: VectorRelativeDegree = relative_degree(at_target().model)
        equations = self.linearised.equations
        self.names: dict[str, RationalFunction] = {"gravity": self.g}
        for known, named in ((equations.state, self.h), (equations.moved, self.v)):
            self.names |= {known[place].name(): symbol for place, symbol in enumerate(named)}
        one, zero = exact(1), exact(0)
        for j, (area, hole) in enumerate(zip(self.A, self.a, strict=True), start=1):
            # Below its rim a tank loses nothing over it, and the document controls the levels
            # themselves, not what sensors show.
            self.names |= {
                f"tank_{j}_area": area, f"outlet_{j}_area": hole, f"outlet_{j}_discharge": one,
                f"tank_{j}_weir": zero, f"tank_{j}_weir_discharge": zero, f"level_{j}_gain": one,
            }  # fmt: skip
        (g1, g2), (k1, k2) = self.gamma, self.k
        self.names |= {"pump_1_gain": k1, "pump_2_gain": k2}
        self.names |= {"splitter_1_tank_1": g1, "splitter_2_tank_2": g2}
        self.names |= {"splitter_1_tank_4": 1 - g1, "splitter_2_tank_3": 1 - g2}

    def exactly(self, expression: ca.SX) -> list[RationalFunction]:
        """Return a CasADi vector in the document's symbols."""
        return exactly(expression, self.names)

    @cached_property
    def rates(self) -> list[RationalFunction]:
        """dh/dt of the process."""
        return self.exactly(self.linearised.equations.rates)

    @cached_property
    def L(self) -> list[RationalFunction]:
        """L of the controller."""
        return self.exactly(self.linearised.drift)

    @cached_property
    def E(self) -> np.ndarray:
        """E of the controller."""
        return matrix([self.exactly(self.linearised.decoupling[j, :].T) for j in range(2)])

    @property
    def out(self) -> list[RationalFunction]:
        """What leaves each tank."""
        return [a * square_root(2 * self.g * h) for a, h in zip(self.a, self.h, strict=True)]


def run() -> Found:
    """Derive what the document derives, and compare every entry."""
    derived = Derived()
    return (
        *_balances(derived), *_decoupling(derived), *_new_inputs(derived), _structure(derived)
    )  # fmt: skip


def _balances(s: Derived) -> Rows:
    q_in, q_out = symbols("q_in q_out")
    (g1, _), (k1, _), (v1, v2), q = s.gamma, s.k, s.v, s.out
    # What tank 1 of the process has, with names for what enters and what leaves it.
    named = {"a1": s.a[0] * q_out / q[0]}
    balance = (s.A[0] * s.rates[0]).with_values(named) - (q[2] + g1 * k1 * v1) + q_in
    balances = {"A dh/dt of a tank, read without a sign between its terms": balance}
    balances |= {f"A{j + 1} dh{j + 1}/dt": s.A[j] * s.rates[j] for j in range(4)}
    # u is [v1, v2] in section 3.
    names = {"u1": v1, "u2": v2}
    rates = zip(("dy1/dt, read without its second plus sign", "dy2/dt"), s.rates[:2], strict=True)
    fed = [
        [j for j, rate in enumerate(s.rates, start=1) if str(v) in rate.symbols] for v in (v1, v2)
    ]
    yield PRINTED["section 2", "tanks of each pump"].stated(
        f"v1: {fed[0][0]} and {fed[0][1]}; v2: {fed[1][0]} and {fed[1][1]}",
        fed == [[1, 4], [2, 3]],
    )
    outputs = set().union(*(h.symbols for h in s.h[:2]))
    yield PRINTED["section 3", "what y of (1) is"].stated(
        "controlled output", bool(outputs & set(map(str, s.v)))
    )
    yield from PRINTED.formulas("section 2", balances)
    yield from (PRINTED["section 3", name].formula(rate, names=names) for name, rate in rates)


def _decoupling(s: Derived) -> Rows:
    place, degrees = "section 3", s.linearised.degrees
    assert degrees[0] == degrees[1]
    formulas = {"L(x), first entry": s.L[0], "L(x), second entry": s.L[1]}
    formulas |= entries("E(x), row {}, column {}", s.E)
    of_E = determinant(s.E)
    regular = of_E != 0 and of_E.symbols.isdisjoint(map(str, s.h))
    # A double integrator, r = 2, tells the general formulas apart.
    state = x1, x2 = s.h[:2]
    f, g = matrix([x2, 0]), matrix([0, 1])

    def lie(of: RationalFunction, field: np.ndarray) -> RationalFunction:
        return (jacobian([of], state) @ field)[0]

    squared, mixed = lie(lie(x1, g), g), lie(lie(x1, f), g)
    last_row = PRINTED["(8)", "last row of E, first and last entry"]
    first, last = last_row.text.split(" … ")
    right = last.replace("gm", "g1")
    yield last_row.stated(f"{right} … {last}", first == right)
    input_appears = PRINTED[place, "derivative in which the input appears"]
    input_appears = input_appears.told(squared=squared, mixed=mixed)
    yield from PRINTED.compared(place, {"relative degrees r1 = r2": degrees[0]})
    yield from PRINTED.formulas(place, formulas)
    yield PRINTED[place, "determinant of E"].claimed(regular, str(of_E))
    yield input_appears.stated(
        "y_j^(r_j) = L_f^(r_j) h_j + L_g L_f^(r_j−1) h_j u", squared == mixed
    )


def _new_inputs(s: Derived) -> Rows:
    nu, p = matrix(symbols("nu1 nu2")), diagonal(symbols("p1 p2"))
    m0, y, K_P, K_I, alpha, excess = symbols("m0 y K_P K_I alpha excess")
    L, M = matrix(s.L), m0 * matrix(s.h[:2])
    for place, name, u in (
        ("(9)", "first entry of Y under u = −E⁻¹ L + E⁻¹ ν", inverse(s.E) @ (nu - L)),
        ("(12)", "first entry of Y under (10)", inverse(s.E) @ (p @ nu - L - M)),
    ):
        outputs = enumerate(L + s.E @ u)
        cases = [(entry, {"nu1": nu[j], "p1": p[j, j], "h1": s.h[j]}) for j, entry in outputs]
        yield PRINTED[place, name].formula_in(cases)
    closed = (p @ nu - M)[0].with_values({"h1": y})
    told = "; ".join(f"{K_I * (-alpha * excess / gain)} with {gain}" for gain in (K_I, K_P))
    line = PRINTED["(11)", "M_i as a sum, the order of its Lie derivatives"]
    index, order = line.text.split("=")[0][-1], line.text.split("L_f^")[1][0]
    yield line.stated(line.text.replace(f"L_f^{order}", f"L_f^{index}"), order == index)
    yield from PRINTED.formulas("(13)", {"dy/dt for r = 1": closed})
    yield PRINTED["(14)", "rate of the integral part K_I η while it saturates"].remark(told)


def _structure(s: Derived) -> Row:
    needed = set(map(str, s.h)) & set().union(*(each.symbols for each in s.L))
    return PRINTED["section 6", "simple structure"].remark(
        f"α in each loop; {len(needed)} levels in L(x)"
    )
