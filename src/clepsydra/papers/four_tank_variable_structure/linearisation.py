"""Sections 2 and 3 in symbols: balances, Lie derivatives, decoupling and what (10) leaves.

What is computed comes from the equations of the process that is simulated, and from the Lie
derivatives that the controller is made of, turned into SymPy.
"""

from __future__ import annotations

import dataclasses
from functools import cached_property
from typing import TYPE_CHECKING, Any

from clepsydra.linear.lie_derivatives import lie_derivative
from clepsydra.linear.relative_degree import VectorRelativeDegree, relative_degree
from clepsydra.papers.comparison import (
    claimed,
    compared,
    compared_formula,
    damaged,
    remark,
    stated,
)
from clepsydra.papers.experiment import Findings
from clepsydra.papers.four_tank_variable_structure.rig import at_target
from clepsydra.papers.four_tank_variable_structure.symbolic import to_sympy
from clepsydra.papers.row import Row

if TYPE_CHECKING:
    import casadi as ca
    from sympy import Expr, Matrix

_BALANCE = "Mass balance: what flows in less what flows out."
_INPUTS = "u is [v1, v2] there."


class Derived:
    """The symbols of the document, and what the program's equations are in them."""

    def __init__(self) -> None:
        from sympy import Integer, symbols

        self.g = symbols("g", positive=True)
        self.A = symbols("A1:5", positive=True)
        self.a = symbols("a1:5", positive=True)
        self.h = symbols("h1:5", positive=True)
        self.gamma = symbols("gamma1:3", positive=True)
        self.k = symbols("k1:3", positive=True)
        self.v = symbols("v1:3", positive=True)
        self.linearised: VectorRelativeDegree = relative_degree(at_target().model)
        equations = self.linearised.equations
        self.names: dict[str, Any] = {"gravity": self.g}
        for symbol, level in zip(ca_names(equations.state), self.h, strict=True):
            self.names[symbol] = level
        for symbol, voltage in zip(ca_names(equations.moved), self.v, strict=True):
            self.names[symbol] = voltage
        for j in range(1, 5):
            self.names[f"tank_{j}_area"] = self.A[j - 1]
            self.names[f"outlet_{j}_area"] = self.a[j - 1]
            self.names[f"outlet_{j}_discharge"] = Integer(1)
            # Below its rim a tank loses nothing over it.
            self.names |= {f"tank_{j}_weir": Integer(0), f"tank_{j}_weir_discharge": Integer(0)}
            # The document controls the levels themselves, not what sensors show.
            self.names[f"level_{j}_gain"] = Integer(1)
        (g1, g2), (k1, k2) = self.gamma, self.k
        self.names |= {"pump_1_gain": k1, "pump_2_gain": k2}
        self.names |= {"splitter_1_tank_1": g1, "splitter_2_tank_2": g2}
        self.names |= {"splitter_1_tank_4": 1 - g1, "splitter_2_tank_3": 1 - g2}

    def sympy(self, expression: ca.SX) -> list[Expr]:
        """Return a CasADi vector in the document's symbols."""
        return to_sympy(expression, self.names)

    @cached_property
    def rates(self) -> list[Expr]:
        """dh/dt of the process."""
        return self.sympy(self.linearised.equations.rates)

    @cached_property
    def L(self) -> list[Expr]:
        """L of the controller."""
        return self.sympy(self.linearised.drift)

    @cached_property
    def E(self) -> Matrix:
        """E of the controller."""
        from sympy import Matrix

        return Matrix([self.sympy(self.linearised.decoupling[j, :].T) for j in range(2)])

    @property
    def out(self) -> list[Expr]:
        """What leaves each tank."""
        from sympy import sqrt

        return [a * sqrt(2 * self.g * h) for a, h in zip(self.a, self.h, strict=True)]


def ca_names(symbols: ca.SX) -> list[str]:
    """Return the names of a vector of CasADi symbols."""
    return [symbols[k].name() for k in range(symbols.numel())]


def linearisation() -> Findings:
    """Derive what the document derives, and compare every entry."""
    derived = Derived()
    rows = [*_balances(derived), *_decoupling(derived), *_new_inputs(derived)]
    return Findings(tuple(rows))


def _balances(s: Derived) -> list[Row]:
    from sympy import symbols

    q_in, q_out = symbols("q_in q_out")
    (g1, g2), (k1, k2), (v1, v2), q = s.gamma, s.k, s.v, s.out
    # What tank 1 of the process has, with names for what enters and what leaves it.
    of_tank_1 = (s.A[0] * s.rates[0]).expand().subs(q[0], q_out)
    entering = q[2] + g1 * k1 * v1
    rows = [
        damaged(
            compared_formula(
                "section 2",
                "A dh/dt of a tank, read without a sign between its terms",
                q_in * q_out,
                (of_tank_1 - entering).expand() + q_in,
                reason="The four balances below have it.",
            ),
            "There is a gap where the minus sign between q_in and q_out has to stand.",
        )
    ]
    printed = (
        -q[0] + q[2] + g1 * k1 * v1,
        -q[1] + q[3] + g2 * k2 * v2,
        -q[2] + (1 - g2) * k2 * v2,
        -q[3] + (1 - g1) * k1 * v1,
    )
    for j, formula in enumerate(printed):
        name = f"A{j + 1} dh{j + 1}/dt"
        rows.append(
            compared_formula("section 2", name, formula, s.A[j] * s.rates[j], reason=_BALANCE)
        )
    inputs = dict(zip((v1, v2), symbols("u1 u2"), strict=True))
    first, second = (-q[0] + q[2] * g1 * k1 * v1) / s.A[0], (-q[1] + q[3] + g2 * k2 * v2) / s.A[1]
    rates = [
        damaged(
            compared_formula(
                "section 3",
                "dy1/dt, read without its second plus sign",
                first,
                s.rates[0],
                reason="The balance of tank 1 has both; the index is restored here, where the text "
                f"has √(2 g h). {_INPUTS}",
            ),
            "There is a gap where the index of h3 and a plus sign have to stand.",
        ),
        compared_formula("section 3", "dy2/dt", second, s.rates[1], reason=f"{_BALANCE} {_INPUTS}"),
    ]
    rows += [
        dataclasses.replace(row, printed=str(formula.subs(inputs)))
        for row, formula in zip(rates, (first, second), strict=True)
    ]
    return rows


def _decoupling(s: Derived) -> list[Row]:
    from sympy import Integer, Matrix

    q, rows = s.out, []
    assert s.linearised.degrees[0] == s.linearised.degrees[1]
    rows.append(
        compared(
            "section 3",
            "relative degrees r1 = r2",
            "1",
            float(s.linearised.degrees[0]),
            why="A pump acts on the first derivative of its level.",
        )
    )
    rows.append(
        compared_formula(
            "section 3", "L(x), first entry", (-q[0] + q[2]) / s.A[0], s.L[0], reason=_BALANCE
        )
    )
    rows.append(
        damaged(
            compared_formula(
                "section 3",
                "L(x), second entry",
                (q[1] + q[3]) / s.A[1],
                s.L[1],
                reason="dy2/dt above it has it.",
            ),
            "The minus sign before a2 √(2 g h2) seems lost.",
        )
    )
    zero = Integer(0)
    printed = (
        (s.gamma[0] * s.k[0] / s.A[0], zero),
        (zero, s.gamma[1] * s.k[1] / s.A[1]),
    )
    for j in range(2):
        for i in range(2):
            name = f"E(x), row {j + 1}, column {i + 1}"
            rows.append(
                compared_formula(
                    "section 3", name, printed[j][i], s.E[j, i],
                    reason="L_g h of (6) with the balances of section 2.",
                )
            )  # fmt: skip
    determinant = s.E.det()
    regular = determinant != 0 and not determinant.has(*s.h)
    rows.append(
        claimed(
            "section 3",
            "determinant of E",
            "E is non-singular so that the four-capacity system can be decoupled",
            bool(regular),
            str(determinant),
            reason="It depends on no level, so that E is regular at every one and each input of "
            "(9) moves its own output alone.",
        )
    )
    # A double integrator, r = 2, tells the general formulas apart.
    x1, x2 = s.h[:2]
    state, f, g = Matrix([x1, x2]), Matrix([x2, 0]), Matrix([0, 1])
    squared = (Matrix([(Matrix([x1]).jacobian(state) * g)[0]]).jacobian(state) * g)[0]
    mixed = (Matrix([(Matrix([x1]).jacobian(state) * f)[0]]).jacobian(state) * g)[0]
    rows.append(
        stated(
            "section 3",
            "derivative in which the input appears",
            "y^(r) = L_f^n h + L_g^n h u",
            "y^(r) = L_f^r h + L_g L_f^(r−1) h u",
            bool(squared == mixed),
            "The first row of (8) has L_g L_f^(r−1) h as the factor of the input, and (7) has "
            "L_f^r h. They are right: for d²y/dt² = u that factor is 1, and L_g² h is "
            f"{squared}, L_g L_f h {mixed}.",
        )
    )
    return rows


def _new_inputs(s: Derived) -> list[Row]:
    from sympy import Matrix, diag, simplify, symbols

    nu, p, m = Matrix(symbols("nu1:3")), diag(*symbols("p1:3")), symbols("m0:4")
    L, M = Matrix(s.L), Matrix([m[0] * s.h[0], m[0] * s.h[1]])
    rows = []
    for place, name, u, printed in (
        ("(9)", "Y under u = −E⁻¹ L + E⁻¹ ν", s.E.inv() * (nu - L), nu),
        ("(12)", "Y under (10)", s.E.inv() * (p * nu - L - M), p * nu - M),
    ):
        found = [simplify(entry) for entry in L + s.E * u]
        # One formula for both entries: the row shows one that differs, if any does.
        j = next((j for j in range(2) if simplify(printed[j] - found[j]) != 0), 0)
        rows.append(compared_formula(place, name, printed[j], found[j], reason="dy/dt = L + E u."))
    equations, chain = s.linearised.equations, s.linearised.derivatives[0][0]
    powers = [s.h[0]]
    for _ in range(3):
        chain = lie_derivative(chain, equations.drift, equations.state)
        powers.append(s.sympy(chain)[0])
    upto = sum(weight * power for weight, power in zip(m, powers, strict=True))
    rows.append(
        damaged(
            compared_formula(
                "(11)",
                "M1 as a sum up to n − 1",
                upto,
                m[0] * s.h[0],
                reason="With r1 = 1 the sum ends at r1 − 1 = 0, as (13) has no derivative above "
                "r − 1, so that M1 is m0 h1, L_f^0 h1 being h1; n − 1 = 3 would bring in three "
                "further Lie derivatives.",
            ),
            "The place is garbled: n may be a misread r_i, and L_f^h beside it a misread L_f^k.",
        )
    )
    y, second = symbols("y m1")
    rows.append(
        compared_formula(
            "(13)",
            "dy/dt for r = 1",
            p[0, 0] * nu[0] - m[0] * y,
            (p * nu - M)[0].subs({s.h[0]: y, second: 0}),
            reason="(12) with M = m0 y of (11) for r = 1, and P = p.",
        )
    )
    K_P, K_I, alpha, excess = symbols("K_P K_I alpha excess", positive=True)
    told = "; ".join(f"{K_I * (-alpha * excess / gain)} with {gain}" for gain in (K_I, K_P))
    rows.append(
        remark(
            "(14)",
            "rate of the integral part K_I η while it saturates",
            "−α (u_n − u_s) / K_1",
            told,
            reason="The excess is u_n − u_s. K_1 is explained nowhere: with K_I in its place α is "
            "the speed at which u_n converges to its range, as the text says; with K_P it is not.",
        )
    )
    return rows
