"""Equations (5) to (7) in symbols, and what the document says of them.

(7) defines J, and the bounds of the vector gain margin in the second equation (6) are a rule of
experience, so that no row judges either.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.linear_quadratic import SIZES, WEIGHT, quadratic_loop
from clepsydra.papers.three_tanks.state_feedback import DISTANCES, placed_loop

if TYPE_CHECKING:
    from sympy import Matrix

_LQC = "design of the LQC"
#: Two sizes of a sensitivity are one [dB].
_SAME = 5e-3


class Symbols:
    """A plant with three states and one input, its feedback, and the weights of its cost."""

    def __init__(self) -> None:
        from sympy import Matrix, Symbol, eye, symbols

        self.s, self.r = symbols("s r")
        self.A = Matrix(3, 3, symbols("a11:14 a21:24 a31:34"))
        self.B = Matrix(symbols("b1:4"))
        self.K = Matrix([symbols("k1:4")])
        self.X, self.u = Matrix(symbols("x1:4")), Matrix([symbols("u")])
        self.P, self.Q = (
            Matrix(3, 3, lambda i, j, name=name: Symbol(f"{name}{min(i, j)}{max(i, j)}"))
            for name in "pq"
        )
        self.R = Matrix([Symbol("R", positive=True)])
        self.names: dict[str, Any] = {
            name: getattr(self, name) for name in ("s", "A", "B", "K", "X", "u", "P", "Q", "R")
        }
        self.names |= {"I": eye(3), "det": lambda matrix: matrix.det()}

    @property
    def slope(self) -> Matrix:
        """The rate of V = Xᵀ P X along dX/dt = A X + B u."""
        moved = self.A * self.X + self.B * self.u
        return moved.T * self.P * self.X + self.X.T * self.P * moved

    @property
    def cost(self) -> Matrix:
        """What (7) integrates, and dV/dt: J less V(0) is its integral."""
        return self.X.T * self.Q * self.X + self.u.T * self.R * self.u + self.slope

    @property
    def best(self) -> Matrix:
        """The input with the least cost."""
        from sympy import Matrix, solve

        (u,) = self.u
        return Matrix(solve(self.cost[0].diff(u), u))

    def are_equal(self, text: str, derived: Any) -> bool:
        """Whether a printed formula is a derived one for all values of its symbols."""
        from sympy import Matrix, expand
        from sympy.parsing.sympy_parser import parse_expr

        difference = Matrix([parse_expr(text, self.names) - derived])
        return all(expand(each) == 0 for each in difference)


def run() -> Found:
    """Derive what (5) to (7) rest on, and compare."""
    from sympy import exp, sympify

    symbols = Symbols()
    gain, delay, lag = (sympify(PRINTED["two-point method", n].text) for n in ("Kp", "td", "τp"))
    two_points = gain * exp(-delay * symbols.s) / (lag * symbols.s + 1)
    yield PRINTED["(5)", "G(s)"].formula(two_points)
    characteristic = (symbols.A - symbols.B * symbols.K).charpoly(symbols.s).as_expr()
    printed = PRINTED["(6)", "left side, whose roots are the closed-loop poles"]
    yield printed.stated("det(s*I - A + B*K)", symbols.are_equal(printed.text, characteristic))
    yield from (*_quadratic_cost(symbols), _weights(), _riccati(), _vector_margin())


def _quadratic_cost(symbols: Symbols) -> Rows:
    from sympy import hessian

    riccati = symbols.A.T * symbols.P + symbols.P * symbols.A + symbols.Q
    riccati -= symbols.P * symbols.B * symbols.R.inv() * symbols.B.T * symbols.P
    # With what (CARE) makes of Q the least cost is zero at every state.
    weight = symbols.Q - riccati
    least = symbols.cost.subs(symbols.u[0], symbols.best[0])
    quadratic = hessian(least[0], list(symbols.X)) / 2
    for name, derived, right in (
        ("left side of the Riccati equation", quadratic, "A.T*P + P*A + Q - P*B*R**-1*B.T*P"),
        (
            "dV/dt with the Riccati equation",
            symbols.slope,
            "(B.T*P*X + R*u).T*R**-1*(B.T*P*X + R*u) - (X.T*Q*X + u.T*R*u)",
        ),
        ("control that minimises J", symbols.best, "-R**-1*B.T*P*X"),
    ):
        printed = PRINTED[_LQC, name]
        if name.startswith("dV/dt"):
            symbols.names["Q"] = weight
        yield printed.stated(right, symbols.are_equal(printed.text, derived))


def _weights() -> Row:
    Q = np.diag([0.0, 0.0, WEIGHT])
    (idle, *_), directions = np.linalg.eigh(Q)
    level = int(np.argmax(np.abs(directions[:, 0])))
    return PRINTED["(7)", "XᵀQX"].claimed(
        bool(idle > 0.0), f"{idle:g} where only h{level + 1} is off its rest"
    )


def _riccati() -> Row:
    counts, smallest = [], []
    for weight in SIZES:
        definite = [P for P in _solutions(weight) if np.linalg.eigvalsh(P)[0] > 0.0]
        counts.append(len(definite))
        smallest.append(float(np.linalg.eigvalsh(definite[0])[0]) if definite else np.nan)
    return PRINTED[_LQC, "P"].claimed(
        counts == [1] * len(SIZES),
        ", ".join(
            f"R = {weight}: {count} with eigenvalues from {least:.2g}"
            for weight, count, least in zip(SIZES, counts, smallest, strict=True)
        ),
    )


def _solutions(weight: str) -> list[np.ndarray]:
    """Return every real symmetric solution of the Riccati equation of an R as printed.

    Each is spanned by three eigenvectors of the Hamiltonian matrix, with every pair whole.
    """
    model = quadratic_loop(weight).model
    A, B, Q = model.A, model.B, np.diag([0.0, 0.0, WEIGHT])
    values, vectors = np.linalg.eig(np.block([[A, -B @ B.T / float(weight)], [-Q, -A.T]]))
    found = []
    for chosen in itertools.combinations(range(6), 3):
        poles = np.sort_complex(values[list(chosen)])
        if np.allclose(poles, np.sort_complex(poles.conj())):
            upper, lower = np.split(vectors[:, chosen], 2)
            found.append(np.linalg.solve(upper.T, lower.T).T.real)
    return found


def _vector_margin() -> Row:
    loops = [*map(placed_loop, DISTANCES), *map(quadratic_loop, SIZES)]
    apart = {
        loop.label: (loop.vector_gain_margins[0], loop.sensitivity_at_phase_crossings[0])
        for loop in loops
        if loop.sensitivity_at_phase_crossings[0]
    }
    is_right = all(abs(max(sizes) - peak) < _SAME for peak, sizes in apart.values())
    label, (peak, sizes) = next(reversed(apart.items()))
    line = PRINTED["second equation (6)", "frequency at which 1/|1 + L| is taken"]
    line = line.told(loop=label, there=max(sizes), peak=peak)
    return line.stated("that of its maximum", is_right)
