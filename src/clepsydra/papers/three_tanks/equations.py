"""Equations (5) to (7) in symbols, and what the document says of them.

(7) defines J, and the bounds of the vector gain margin in the second equation (6) are a rule of
experience, so that no row judges either.
"""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np

from clepsydra.base.words import listed
from clepsydra.papers.document import Found
from clepsydra.papers.exact_matrix import determinant, identity, inverse, jacobian, matrix
from clepsydra.papers.formula import read_formula
from clepsydra.papers.printed import Printed
from clepsydra.papers.rational_function import symbols
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.three_tanks import PRINTED
from clepsydra.papers.three_tanks.linear_quadratic import (
    SIZES,
    WEIGHT,
    optimal_loop,
    quadratic_loop,
)
from clepsydra.papers.three_tanks.printed_model import printed_model
from clepsydra.papers.three_tanks.state_feedback import DISTANCES, placed_loop

_LQC = "design of the LQC"
#: Two sizes of a sensitivity are one [dB].
_SAME = 5e-3


class Symbols:
    """A plant with three states and one input, its feedback, and the weights of its cost."""

    def __init__(self) -> None:
        (self.s,) = symbols("s")
        self.A = matrix([symbols(f"a{row}1 a{row}2 a{row}3") for row in "123"])
        self.B, self.X = (matrix(symbols(f"{x}1 {x}2 {x}3")).reshape(3, 1) for x in "bx")
        self.K, self.u, self.R = (matrix([symbols(name)]) for name in ("k1 k2 k3", "u", "R"))
        self.P, self.Q = (
            matrix([symbols(f"{x}11 {x}12 {x}13"), symbols(f"{x}12 {x}22 {x}23"),
                    symbols(f"{x}13 {x}23 {x}33")])
            for x in "pq"
        )  # fmt: skip
        self.names: dict[str, Any] = {
            name: getattr(self, name) for name in ("A", "B", "K", "X", "u", "P", "Q", "R")
        }
        self.names |= {"I": identity(3), "dX": self.moved}

    @property
    def moved(self) -> np.ndarray:
        """dX/dt along the plant."""
        return np.asarray(self.A @ self.X + self.B @ self.u)

    @property
    def slope(self) -> np.ndarray:
        """The rate of V = Xᵀ P X along dX/dt = A X + B u."""
        value = (self.X.T @ self.P @ self.X)[0, 0]
        (gradient,) = jacobian([value], self.X[:, 0])
        return np.asarray(matrix([gradient]) @ self.moved)

    @property
    def cost(self) -> np.ndarray:
        """What (7) integrates, and dV/dt: J less V(0) is its integral."""
        return self.X.T @ self.Q @ self.X + self.u.T @ self.R @ self.u + self.slope

    @property
    def best(self) -> np.ndarray:
        """The input with the least cost."""
        return matrix([[self.cost[0, 0].derivative("u").root("u")]])

    def judged(self, line: Printed, right: str, derived: Any) -> Row:
        """Compare a printed formula with a derived one, which is said as `right` has it."""
        assert self.are_equal(right, derived), right
        return line.stated(right, self.are_equal(line.text, derived))

    def are_equal(self, text: str, derived: Any) -> bool:
        """Whether a printed formula is a derived one for all values of its symbols."""
        return not np.any(read_formula(text, self.names) != derived)


def run() -> Found:
    """Derive what (5) to (7) rest on, and compare."""
    of = Symbols()
    gain, delay, lag = (PRINTED["two-point method", name].text for name in ("Kp", "td", "τp"))
    two_points, printed = f"{gain}*exp(-{delay}*s)/({lag}*s + 1)", PRINTED["(5)", "G(s)"]
    yield printed.stated(two_points, of.are_equal(printed.text, read_formula(two_points)))
    characteristic = determinant(of.s * identity(3) - (of.A - of.B @ of.K))
    printed = PRINTED["(6)", "left side, whose roots are the closed-loop poles"]
    yield of.judged(printed, "det(s*I - A + B*K)", characteristic)
    yield from (*_quadratic_cost(of), _cost_of_any_feedback())
    yield from (*_weights(), _riccati(), _vector_margin())


def _quadratic_cost(of: Symbols) -> Rows:
    riccati = of.A.T @ of.P + of.P @ of.A + of.Q
    riccati = riccati - of.P @ of.B @ inverse(of.R) @ of.B.T @ of.P
    # With what (CARE) makes of Q the least cost is zero at every state.
    weight = of.Q - riccati
    least = of.cost[0, 0].with_values({"u": of.best[0, 0]})
    state = of.X[:, 0]
    quadratic = jacobian(jacobian([least], state)[0], state) * Fraction(1, 2)
    best = jacobian(of.best[0], state)
    for name, derived, right in (
        ("left side of the Riccati equation", quadratic, "A.T*P + P*A + Q - P*B*R**-1*B.T*P"),
        ("K", -best, "R**-1*B.T*P"),
        ("dV/dt", of.slope, "dX.T*P*X + X.T*P*dX"),
        ("dV/dt along the plant", of.slope, "(A*X + B*u).T*P*X + X.T*P*(A*X + B*u)"),
        ("dV/dt in terms", of.slope, "X.T*(A.T*P + P*A)*X + u.T*B.T*P*X + X.T*P*B*u"),
        ("AᵀP + PA", of.A.T @ of.P + of.P @ of.A - quadratic, "-Q + P*B*R**-1*B.T*P"),
        (
            "dV/dt with the Riccati equation",
            of.slope,
            "(B.T*P*X + R*u).T*R**-1*(B.T*P*X + R*u) - (X.T*Q*X + u.T*R*u)",
        ),
        ("control that minimises J", of.best, "-R**-1*B.T*P*X"),
    ):
        if name == "dV/dt with the Riccati equation":
            of.names["Q"] = weight
        yield of.judged(PRINTED[_LQC, name], right, derived)


def _cost_of_any_feedback() -> Row:
    """Check J = ∫(7) of u = -L X against XᵀPX and the integral, for all X by their matrices."""
    from scipy.linalg import solve_continuous_lyapunov

    apart = []
    for weight in SIZES:
        quadratic = quadratic_loop(weight)
        model, effort = quadratic.model, float(weight)
        _, P = optimal_loop(model, WEIGHT, effort)
        for loop in map(placed_loop, DISTANCES):
            # BᵀPX + R u is R (K - L) X.
            spent = np.diag([0.0, 0.0, WEIGHT]) + effort * loop.gain.T @ loop.gain
            off = quadratic.gain - loop.gain
            cost, excess = (
                solve_continuous_lyapunov(loop.closed.T, -each)
                for each in (spent, effort * off.T @ off)
            )
            apart.append(float(np.abs(P + excess - cost).max() / np.abs(cost).max()))
    line = PRINTED[_LQC, "J of any feedback"]
    return line.stated(line.text, max(apart) < 1e-6)


def _weights() -> Rows:
    Q = np.diag([0.0, 0.0, WEIGHT])
    (idle, *_), directions = np.linalg.eigh(Q)
    level = int(np.argmax(np.abs(directions[:, 0])))
    yield PRINTED["(7)", "XᵀQX"].claimed(
        bool(idle > 0.0), f"{idle:g} where only h{level + 1} is off its rest"
    )
    slowest = [float(np.linalg.eigvals(quadratic_loop(R).closed).real.max()) for R in SIZES]
    yield PRINTED["(7)", "states"].claimed(
        max(slowest) < 0.0, ", ".join(f"{pole:.2f}" for pole in slowest)
    )
    inputs = printed_model().B.shape[1]
    yield PRINTED["(7)", "what R penalises"].stated("uᵀRu", inputs == len(Q))


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
    assert not any(abs(max(sizes) - peak) < _SAME for peak, sizes in apart.values())
    label, (peak, sizes) = next(reversed(apart.items()))
    line = PRINTED["second equation (6)", "frequency at which 1/|1 + L| is taken"]
    there = listed([f"{size:.2f} dB" for size in sizes])
    return line.remark(f"{there} there, and {peak:.2f} dB at its maximum, with {label}")
