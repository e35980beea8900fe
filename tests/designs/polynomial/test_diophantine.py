"""The identity holds exactly, and the solution is that of a Sylvester matrix."""

from fractions import Fraction

import numpy as np
import pytest
from refusals import refused

from clepsydra.designs.polynomial.diophantine import product, rational, solve_diophantine
from clepsydra.designs.polynomial.spectral_factor import SpectralFactor, spectral_factor
from clepsydra.designs.polynomial.two_degree_of_freedom import (
    INTEGRAL,
    Characteristic,
    assigned,
    two_degree_of_freedom,
)


def total(first, second):
    size = max(len(first), len(second))
    first, second = ([*p, *[Fraction(0)] * (size - len(p))] for p in (first, second))
    return tuple(a + b for a, b in zip(first, second, strict=True))


def closed_loop(A, B, found):
    return total(product(product(A, INTEGRAL), found.P), product(B, found.Q))


@pytest.mark.parametrize("seed", range(30))
def test_the_identity_is_exact(seed):
    """Random models with delay, roots of D as near to 1 as 1e-6 among them."""
    random = np.random.default_rng(seed)
    order, delay = int(random.integers(1, 4)), int(random.integers(0, 6))
    A = tuple(np.real(np.poly(random.uniform(0.2, 1.1, order))))
    B = (0.0, *[0.0] * delay, *random.normal(size=order))
    degree = order + int(random.integers(0, 2))
    gaps = 10.0 ** random.uniform(-6, -0.3, degree)
    D = Characteristic(tuple(np.real(np.poly(1.0 - gaps))), float(np.prod(gaps)))
    found = two_degree_of_freedom(A, B, D)
    assert total(closed_loop(A, B, found), ()) == total(
        rational(D.coefficients), [Fraction(0)] * len(closed_loop(A, B, found))
    )


def test_the_solution_of_a_sylvester_matrix():
    A, B, C = [1.0, -1.5, 0.7], [0.0, 0.4, 0.2], [1.0, -0.4, 0.1, 0.0]
    X, Y = solve_diophantine(A, B, C, degree_x=1, degree_y=1)
    matrix = np.zeros((4, 4))
    for column in range(2):
        matrix[column : column + 3, column] = A
        matrix[column : column + 3, 2 + column] = B
    expected = np.linalg.solve(matrix, C)
    assert [float(value) for value in (*X, *Y)] == pytest.approx(expected, abs=1e-12)


def test_the_second_equation_and_r0():
    """S (1 − z^-1) + B r0 = D has a solution S just for r0 = D(1)/B(1)."""
    A, B = (1.0, -1.777, 0.7964), (0.0, 0.0309, 0.0286)
    D = assigned(spectral_factor(A, B, 10.0), [0.5])
    found = two_degree_of_freedom(A, (0.0, sum(B)), D)
    assert found.feedforward == pytest.approx(sum(D.coefficients) / sum(B), rel=1e-12)
    # Equation (22) at z = 1 gives Q(1) the same value, so that the error alone is integrated.
    assert float(sum(found.Q)) == pytest.approx(found.feedforward, rel=1e-12)


def test_polynomials_with_a_common_root_are_refused():
    with refused(expected="common root"):
        solve_diophantine([1, -1], [2, -2], [1, 3], degree_x=0, degree_y=0)
    with refused(expected="common root"):
        two_degree_of_freedom((1.0, -0.5), (0.0, 1.0, -0.5), Characteristic((1.0, -0.2), 0.8))


def test_what_no_controller_can_hold_is_refused():
    D = Characteristic((1.0, -0.2), 0.8)
    with refused(place="B(1)"):
        two_degree_of_freedom((1.0, -0.5), (0.0, 1.0, -1.0), D)


@pytest.mark.parametrize("complex_pair", [True, False])
def test_the_product_of_the_roots(complex_pair):
    """(33), and (31) with d3 = −αβγ: the third coefficient closes the product (30)."""
    a, b, c = 0.8, 0.3, 0.5
    roots = (a + 1j * b, a - 1j * b) if complex_pair else (a, b)
    factor = SpectralFactor(
        tuple(np.real(np.poly(roots))), tuple(map(complex, roots)),
        float(np.prod([1 - r for r in roots]).real), 1.0,
    )  # fmt: skip
    found = assigned(factor, [c])
    if complex_pair:
        expected = (1.0, -(2 * a + c), 2 * a * c + a * a + b * b, -(a * a + b * b) * c)
    else:
        expected = (1.0, -(a + b + c), a * b + a * c + b * c, -a * b * c)
    assert found.coefficients == pytest.approx(expected, abs=1e-14)
    assert np.abs(np.roots(found.coefficients)).max() < 1.0
    assert found.at_one == pytest.approx(sum(expected), abs=1e-14)
