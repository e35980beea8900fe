"""Section 5: Diophantine equations, spectral factorisation and the assigned pole."""

from __future__ import annotations

from functools import cache

import numpy as np

from clepsydra.designs.polynomial.diophantine import product, rational
from clepsydra.designs.polynomial.sampled_model import SampledModel
from clepsydra.designs.polynomial.spectral_factor import SpectralFactor, spectral_factor
from clepsydra.designs.polynomial.two_degree_of_freedom import (
    INTEGRAL,
    TwoDegreeOfFreedom,
    assigned,
    two_degree_of_freedom,
)
from clepsydra.papers.document import Found
from clepsydra.papers.eight_tanks import PRINTED
from clepsydra.papers.eight_tanks.six_designs import (
    PENALTIES,
    POLES,
    SIX,
    printed_model,
    sampled_chain,
)
from clepsydra.papers.rational_function import RationalFunction, square_root, symbols
from clepsydra.papers.row import Row, Rows

#: What the numerical roots leave of rounding.
_ROUNDING = 1e-10
#: The same of the Riccati equation.
_NINE_DIGITS = 1e-9


def run() -> Found:
    """Return the rows of section 5."""
    return (*_equations(), *_counts(), _feedforward(), *_poles(), *_factor(), _least_criterion())


def factor(penalty: float, model: SampledModel | None = None) -> SpectralFactor:
    """Return the spectral factor of model (21), or of another, by a penalty."""
    model = model or printed_model()
    return spectral_factor(tuple(map(float, model.A)), tuple(map(float, model.B)), penalty)


def controller(penalty: float, poles: tuple[float, ...], *, full: bool) -> TwoDegreeOfFreedom:
    """Return the solution of (22) with B(1) z^-1, as in Fig. 5, or with the full B as printed."""
    model = printed_model()
    D = assigned(factor(penalty), poles)
    B = tuple(model.B) if full else (0.0, float(np.sum(model.B)))
    return two_degree_of_freedom(tuple(model.A), B, D)


def _coefficients(found: TwoDegreeOfFreedom) -> int:
    """Return how many numbers (22) gives: Q, and P without its leading 1."""
    return len(found.Q) + len(found.P) - 1


def _counts() -> Rows:
    plain, full = (controller(10.0, (0.5,), full=choice) for choice in (False, True))
    model = printed_model()
    D = assigned(factor(10.0), (0.5,))
    left = product(product(tuple(model.A), INTEGRAL), plain.P)
    right = product(rational([0.0, float(np.sum(model.B))]), plain.Q)
    exact = all(a + b == d for a, b, d in zip(left, right, rational(D.coefficients), strict=True))
    counts = _coefficients(plain), _coefficients(full)
    yield PRINTED["(22)", "feedback parameters"].stated(
        f"{counts[0]} with B(1), {counts[1]} with the full B",
        7 in counts or not exact,
        degree=D.degree,
        count=counts[0],
    )


def _equations() -> Rows:
    """Derive (22) and (23) from the controller output (25) on A y = B u."""
    A, B, K, P, Q, R, D_w, w, y = symbols("A B K P Q R D_w w y")
    u = A * y / B
    level = (K * P * u - (R * w - Q * y)).root("y")
    D = B * R * w / level
    yield PRINTED["(22), (25)", "characteristic polynomial of the loop"].formula(D)
    S = (w - level) * D / (D_w * w)
    yield PRINTED["(23), (25)", "characteristic polynomial by the error"].formula(D, names={"S": S})


def _feedforward() -> Row:
    S, B, R, D, back = symbols("S B R D x")
    # S (1 − x) + B R = D at x = 1.
    left = (S * (1 - back) + B * R).with_values({"x": 1})
    solution = (left - D).root("R")
    return PRINTED["(24)", "r0"].stated(f"{solution} at z = 1", solution == D / B)


def _poles() -> Rows:
    z, a, b, c = symbols("z alpha beta gamma")
    i = square_root(-1)
    for place, product_of in (
        ("(31)", (z - a) * (z - b) * (z - c)),
        ("(33)", (z - a - i * b) * (z - a + i * b) * (z - c)),
    ):
        found = map(RationalFunction, product_of.numerator.all_coefficients("z")[1:])
        names = ("d1", "d2", "d3")
        yield from PRINTED.formulas(place, dict(zip(names, found, strict=True)))


def _factor() -> Rows:
    factors = {choice: factor(choice.penalty) for choice in SIX}
    roots = {choice: np.abs(np.roots(_whole(choice.penalty))) for choice in SIX}
    (stable,) = {int(np.sum(each < 1.0)) for each in roots.values()}
    yield PRINTED["(27), (28)", "degree of the spectral factor"].claimed(
        all(len(each.coefficients) - 1 == stable == 2 for each in factors.values()),
        "; ".join(
            f"q_u = {choice.penalty:g}: d1 = {each.coefficients[1]:.6f}, d2 = "
            f"{each.coefficients[2]:.6f}"
            for choice, each in factors.items()
            if choice in (PENALTIES[0], POLES[0])
        ),
        roots=len(roots[SIX[0]]),
        stable=stable,
    )
    yield PRINTED["section 7", "design without numerical methods"].claimed(
        _largest_error() < _ROUNDING, f"largest difference below {_ROUNDING:g}"
    )
    simple, chain = controller(10.0, (0.5,), full=False), sampled_chain()
    D = assigned(factor(10.0), (0.5,))
    direct = two_degree_of_freedom(tuple(chain.A), tuple(chain.B), D)
    # r0 of both; a1, a2, b1, b2 and d of the predictor.
    counts = _coefficients(simple) + 1 + 5, _coefficients(direct) + 1
    yield PRINTED["section 7", "relatively simple controllers"].claimed(
        counts[0] < counts[1],
        f"{counts[0]} against {counts[1]}",
        last=len(direct.Q),
        increments=len(direct.P) - 1,
    )


def _whole(penalty: float) -> np.ndarray:
    """Return z² (A(z) q_u A(z^-1) + B(z) B(z^-1)) of (21)."""
    model = printed_model()
    whole = penalty * np.convolve(model.A, model.A[::-1])
    return np.asarray(whole + np.convolve(model.B, model.B[::-1]))


@cache
def _largest_error() -> float:
    """Return the largest difference of the closed form to numerical roots."""
    worst = 0.0
    for penalty in np.geomspace(0.01, 1000.0, 26):
        roots = np.roots(_whole(float(penalty)))
        stable = np.real(np.poly(roots[np.argsort(np.abs(roots))[:2]]))
        closed = factor(float(penalty)).coefficients
        worst = max(worst, float(np.max(np.abs(stable - closed))))
    return worst


def _least_criterion() -> Row:
    """Compare (27) with the state feedback that makes the sum (26) smallest when w is zero."""
    from scipy.linalg import solve_discrete_are

    model, penalty = printed_model(), POLES[0].penalty
    (a1, a2), (b1, b2) = model.denominator, model.numerator
    # y(k), y(k-1) and u(k-1).
    step = np.array([[-a1, -a2, b2], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    by_input = np.array([[b1], [0.0], [1.0]])
    weight, of_input = np.diag([1.0, 0.0, 0.0]), np.array([[penalty]])
    cost = solve_discrete_are(step, by_input, weight, of_input)
    moved = by_input.T @ cost
    gain = np.linalg.solve(of_input + moved @ by_input, moved @ step)
    # The third root is that of u(k-1), zero.
    D = np.poly(step - by_input @ gain)[:3]
    apart = float(np.max(np.abs(D - factor(penalty).coefficients)))
    return PRINTED["(27)", "D of the smallest J, with w = 0"].stated(
        f"d1 = {D[1]:.6f}, d2 = {D[2]:.6f} for q_u = {penalty:g}", apart < _NINE_DIGITS
    )
