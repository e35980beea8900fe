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
from clepsydra.papers.eight_tanks.six_designs import PENALTIES, POLES, SIX, printed_model
from clepsydra.papers.rational_function import RationalFunction, square_root, symbols
from clepsydra.papers.row import Row, Rows

#: What the numerical roots leave of rounding.
_ROUNDING = 1e-10


def run() -> Found:
    """Return the rows of section 5."""
    return (*_counts(), _feedforward(), *_poles(), *_factor())


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
    yield PRINTED["(27), (28)", "degree of the spectral factor"].claimed(
        all(len(each.coefficients) == 3 for each in factors.values()),
        "; ".join(
            f"q_u = {choice.penalty:g}: d1 = {each.coefficients[1]:.6f}, d2 = "
            f"{each.coefficients[2]:.6f}"
            for choice, each in factors.items()
            if choice in (PENALTIES[0], POLES[0])
        ),
    )
    yield PRINTED["section 7", "design without numerical methods"].claimed(
        _largest_error() < _ROUNDING, f"largest difference below {_ROUNDING:g}"
    )


@cache
def _largest_error() -> float:
    """Return the largest difference of the closed form to numerical roots."""
    model = printed_model()
    worst = 0.0
    for penalty in np.geomspace(0.01, 1000.0, 26):
        whole = penalty * np.convolve(model.A, model.A[::-1])
        whole += np.convolve(model.B, model.B[::-1])
        roots = np.roots(whole)
        stable = np.real(np.poly(roots[np.argsort(np.abs(roots))[:2]]))
        closed = factor(float(penalty)).coefficients
        worst = max(worst, float(np.max(np.abs(stable - closed))))
    return worst
