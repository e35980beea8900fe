"""The closed form against the roots of the whole polynomial, and against a Riccati equation."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from clepsydra import InputError
from clepsydra.designs.polynomial.spectral_factor import about_one, spectral_factor

PRINTED = (1.0, -1.777, 0.7964), (0.0, 0.0309, 0.0286)


def by_roots(A, B, penalty):
    """The n stable roots of z^n (q A A* + B B*)."""
    size = max(len(A), len(B))
    A, B = (np.concatenate([p, np.zeros(size - len(p))]) for p in (A, B))
    roots = np.roots(penalty * np.convolve(A, A[::-1]) + np.convolve(B, B[::-1]))
    return roots[np.argsort(np.abs(roots))[: size - 1]]


def by_riccati(A, B, penalty):
    """Poles of the regulator that minimises Σ y² + q u², in controllable canonical form."""
    n = max(len(A), len(B)) - 1
    a = np.concatenate([A[1:], np.zeros(n + 1 - len(A))])
    c = np.concatenate([B[1:], np.zeros(n + 1 - len(B))])[None, :]
    F, G = np.vstack([-a[None, :], np.eye(n - 1, n)]), np.eye(n, 1)
    X = solve_discrete_are(F, G, c.T @ c, penalty * np.eye(1))
    gain = np.linalg.solve(penalty + G.T @ X @ G, G.T @ X @ F)
    return np.linalg.eigvals(F - G @ gain)


def models():
    random = np.random.default_rng(3)
    for _ in range(40):
        order = int(random.integers(1, 3))
        radius, angle = random.uniform(0.1, 1.3), random.uniform(0.0, np.pi)
        roots = [random.uniform(-0.9, 1.3)]
        if order == 2:
            roots = radius * np.exp([1j * angle, -1j * angle])
        B = (0.0, *random.normal(size=int(random.integers(1, order + 2))))
        yield tuple(np.real(np.poly(roots))), B, float(10 ** random.uniform(-3, 3))


@pytest.mark.parametrize(("A", "B", "penalty"), list(models()))
def test_poles_agree_with_the_roots_and_with_the_regulator(A, B, penalty):
    found = spectral_factor(A, B, penalty)
    degree = max(len(A), len(B)) - 1
    closed = np.real(np.poly(np.array([*found.poles, *[0.0] * (degree - len(found.poles))])))
    assert np.max(np.abs(found.poles)) < 1.0
    for other in (by_roots, by_riccati):
        assert closed == pytest.approx(np.real(np.poly(other(A, B, penalty))), abs=1e-7), other


@pytest.mark.parametrize(("A", "B", "penalty"), list(models()))
def test_the_identity_holds_on_the_unit_circle(A, B, penalty):
    found = spectral_factor(A, B, penalty)
    z = np.exp(1j * np.linspace(0.0, np.pi, 50))
    left = penalty * np.abs(np.polyval(A[::-1], z)) ** 2 + np.abs(np.polyval(B[::-1], z)) ** 2
    right = found.scale * np.abs(np.polyval(found.coefficients[::-1], z)) ** 2
    assert right == pytest.approx(left, rel=1e-9, abs=1e-12 * np.max(left))
    assert found.at_one == pytest.approx(sum(found.coefficients), abs=1e-13)


def test_the_factors_of_the_printed_model():
    """As the solution of (27) by another hand has them."""
    for penalty, d1, d2 in ((1.0, -1.622621, 0.680470), (10.0, -1.742615, 0.769174)):
        found = spectral_factor(*PRINTED, penalty)
        assert found.coefficients[1:] == pytest.approx((d1, d2), abs=5e-7)
        assert abs(found.poles[0].imag) > 0.05


def test_real_roots():
    """The branch that the printed model does not reach: two lags far apart."""
    A, B = tuple(np.poly([0.98, 0.5])), (0.0, 0.02, 0.01)
    found = spectral_factor(A, B, 1.0)
    assert all(pole.imag == 0.0 for pole in found.poles)
    assert sorted(p.real for p in found.poles) == pytest.approx(sorted(by_riccati(A, B, 1.0).real))


def test_no_digits_are_lost_where_sampling_is_fast():
    """All roots at 1 − 1e-5: the whole polynomial's coefficients cancel to 1e-20 there."""
    from fractions import Fraction

    gaps = Fraction(1, 2**17), Fraction(1, 2**16)
    A = 1.0, float(-(2 - gaps[0] - gaps[1])), float((1 - gaps[0]) * (1 - gaps[1]))
    assert Fraction(A[2]) == (1 - gaps[0]) * (1 - gaps[1])  # no rounding
    B = 0.0, 2.0**-34
    found = spectral_factor(A, B, 2.0**-4)
    q, b = Fraction(2.0**-4), Fraction(B[1])
    # (1 − p)²/p = −w with q (g1² + (1−g1) w)(g2² + (1−g2) w) + b² = 0, for the exact roots w.
    for pole in found.poles:
        gap = complex(1.0 - pole)
        w = -(gap**2) / complex(pole)
        value = complex(q)
        for g in gaps:
            value *= float(g) ** 2 + float(1 - g) * w
        assert abs(value + float(b) ** 2) < 1e-4 * float(b) ** 2
    scaled = found.at_one * found.at_one * found.scale
    assert scaled == pytest.approx(float(q * (gaps[0] * gaps[1]) ** 2 + b**2), rel=1e-9)


def test_about_one_is_taylors_expansion():
    polynomial = [0.3, -2.0, 5.0, 0.25]
    alpha = about_one(polynomial)
    for x in (0.3, -1.7):
        assert np.polyval(alpha[::-1], x) == pytest.approx(np.polyval(polynomial[::-1], 1.0 - x))


@pytest.mark.parametrize(
    ("A", "B", "penalty", "place"),
    [
        ((1.0, -1.0), (0.0, 0.0), 1.0, "unit circle"),
        ((1.0, -1.0), (0.0, 1.0, -1.0), 1.0, "unit circle"),
        ((0.0, 0.0), (0.0, 0.0), 1.0, "not all zero"),
    ],
)
def test_what_has_no_factor_is_refused(A, B, penalty, place):
    with pytest.raises(InputError, match=place):
        spectral_factor(A, B, penalty)
