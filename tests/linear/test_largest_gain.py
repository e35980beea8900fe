"""The largest gain of random systems, judged by exact root counts and by dense grids."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from clepsydra.linear.frequency_peak import largest_gain, largest_gains


def random_system(seed):
    """Stable, up to six states whose speeds span up to eight decades, of five kinds."""
    numbers = np.random.default_rng(seed)
    normal, n, m = numbers.standard_normal, numbers.integers(1, 7), numbers.integers(1, 3)
    span = numbers.uniform(1.0, 4.0)
    rates = 10.0 ** numbers.uniform(-span, span, n)
    B, C, D = normal((n, m)), normal((m, n)), np.eye(m)
    kind = seed % 5
    if kind == 0:  # tanks in a row
        A = np.tril(10.0 ** numbers.uniform(-3.0, 3.0, (n, n)) * normal((n, n)), -1)
        A, D = A - np.diag(rates), normal((m, m)) * 10.0 ** numbers.uniform(-4.0, 0.0)
    elif kind == 1:  # tanks beside each other
        A, B = -np.diag(rates), B * rates[:, None]
    elif kind == 2:  # coupled both ways
        A = normal((n, n)) * np.sqrt(rates[:, None] * rates) * 10.0 ** numbers.uniform(-3.0, 0.0)
        A, D = A - np.diag(rates), 0.0 * D
    elif kind == 3:  # the sensitivity of a loop
        A = np.tril(normal((n, n)), -1) * rates[:, None] - np.diag(rates)
        A[0, 0] = 0.0
        B *= 10.0 ** numbers.uniform(-3.0, 1.0)
        A, C = A - B @ C, -C
    else:  # resonances beside lags
        A, damping = -np.diag(rates), 10.0 ** numbers.uniform(-5.0, 0.0)
        for i in range(0, n - 1, 2):
            A[i : i + 2, i : i + 2] = rates[i] * np.array([[-damping, 1.0], [-1.0, -damping]])
    stable = np.linalg.eigvals(A).real.max() < 0.0
    return (A, B, C, D) if stable else random_system(seed + 1_000_000)


def gains(system, omegas):
    A, B, C, D = system
    inner = np.linalg.solve(1j * omegas[:, None, None] * np.eye(len(A)) - A, B[None] + 0j)
    return np.linalg.norm(C @ inner + D, 2, axis=(1, 2))


def reference(system):
    """Return the largest gain by 200 frequencies a decade, more near poles, and local searches."""
    poles = np.linalg.eigvals(system[0])
    low, high = abs(poles).min() / 1e5, abs(poles).max() * 1e5
    parts = [np.zeros(1), np.geomspace(low, high, int(200 * np.log10(high / low)))]
    for pole in poles[poles.imag > 0.1 * abs(poles)]:
        away = np.geomspace(abs(pole.real) / 30.0, abs(pole), 200)
        parts += [pole.imag - away, pole.imag + away]
    omegas = np.unique(np.abs(np.concatenate(parts)))
    found = gains(system, omegas)
    best = max(found.max(), np.linalg.norm(system[3], 2))
    inner = found[1:-1]
    tops = (inner >= found[:-2]) & (inner >= found[2:]) & (inner > 0.99 * best)
    for top in np.flatnonzero(tops) + 1:
        local = minimize_scalar(
            lambda omega: -gains(system, np.array([omega]))[0],
            bounds=(omegas[top - 1], omegas[top + 1]),
            method="bounded",
            options={"xatol": 1e-10 * omegas[top]},
        )
        best = max(best, -local.fun)
    return best


def times(left, right):
    product = [Fraction(0)] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            product[i + j] += a * b
    return product


def squared_size(polynomial):
    """Return |p(jω)|² by powers of ω², for a polynomial by rising powers of s."""
    mirrored = [c * (-1) ** i for i, c in enumerate(polynomial)]
    return [c * (-1) ** i for i, c in enumerate(times(polynomial, mirrored)[::2])]


def transfer_function(A, b, c, d):
    """Return numerator and denominator in exact fractions, by Faddeev and Leverrier."""
    n = len(A)
    exact = np.vectorize(Fraction, otypes=[object])
    A, b, c, d = exact(A), exact(b), exact(c), Fraction(d)
    power, denominator, numerator = exact(np.eye(n)), [Fraction(1)], []
    for k in range(1, n + 1):
        numerator.append(c @ power @ b)
        moved = A @ power
        denominator.append(-np.trace(moved) / k)
        power = moved + denominator[-1] * exact(np.eye(n))
    denominator = denominator[::-1]
    return [x + d * y for x, y in zip([*numerator[::-1], 0], denominator, strict=True)], denominator


def positive_roots(polynomial):
    """Count the distinct roots above zero by Sturm's theorem."""

    def trimmed(p):
        while p and p[-1] == 0:
            p = p[:-1]
        return p

    chain = [trimmed(polynomial), trimmed([i * c for i, c in enumerate(polynomial)][1:])]
    while len(chain[-1]) > 1:
        rest, divisor = list(chain[-2]), chain[-1]
        while len(rest) >= len(divisor):
            factor, shift = rest[-1] / divisor[-1], len(rest) - len(divisor)
            for i, c in enumerate(divisor):
                rest[i + shift] -= factor * c
            rest.pop()
        rest = trimmed([-c for c in rest])
        if not rest:
            break
        chain.append(rest)

    def changes(signs):
        signs = [sign for sign in signs if sign]
        return sum(a * b < 0 for a, b in pairwise(signs))

    signs = [[(p[place] > 0) - (p[place] < 0) for p in chain] for place in (0, -1)]
    return changes(signs[0]) - changes(signs[1])


def crossings(system, level):
    """Count the frequencies above zero at which the only gain of a system has a level."""
    A, B, C, D = system
    numerator, denominator = transfer_function(A, B[:, 0], C[0], D[0, 0])
    square = Fraction(level) ** 2
    above = zip(squared_size(denominator), squared_size(numerator), strict=True)
    return positive_roots([square * d - n for d, n in above])


def judged_exactly(seeds):
    """Nothing crosses just above the peak that is found, and something does just below."""
    judged = 0
    for seed in seeds:
        A, B, C, D = random_system(seed)
        # Few digits keep the fractions short.
        A = np.vectorize(lambda x: float(f"{x:.2e}"))(A)
        system = A, B[:, :1].round(2), C[:1].round(2), D[:1, :1].round(2)
        if np.linalg.eigvals(A).real.max() >= 0.0:
            continue
        found = largest_gain(*system)
        assert crossings(system, found.peak * (1.0 + 3e-9)) == 0, seed
        if 0.0 < found.frequency < np.inf:
            assert crossings(system, found.peak * (1.0 - 3e-9)) > 0, seed
        judged += 1
    return judged


def determined(system):
    """Tell whether double precision gives the gains, in whatever order the states stand."""
    A, B, C, D = system
    omegas = np.concatenate([[0.0], abs(np.linalg.eigvals(A))])
    turned = A[::-1, ::-1], B[::-1], C[:, ::-1], D
    return np.allclose(gains(system, omegas), gains(turned, omegas), rtol=1e-10, atol=0.0)


def judged_on_grids(seeds):
    judged = 0
    for seed in seeds:
        system = random_system(seed)
        if determined(system):
            judged += 1
            assert largest_gain(*system).peak == pytest.approx(reference(system), rel=3e-9), seed
    return judged


def test_a_peak_that_rounding_hides_from_level_sets():
    """Eigenvalues of a Hamiltonian matrix do not show a fifth of this one."""
    assert judged_on_grids([4150]) == 1


def test_no_peak_of_random_systems_is_missed():
    assert judged_exactly(range(12)) > 5


def test_side_by_side_each_peak_is_the_one_that_is_found_alone():
    alike = {}
    for system in map(random_system, range(100)):
        alike.setdefault((len(system[0]), len(system[3])), []).append(system)
    for systems in alike.values():
        together = largest_gains(*map(np.array, zip(*systems, strict=True)))
        assert together == [largest_gain(*system) for system in systems]
    assert max(map(len, alike.values())) > 5


@pytest.mark.thorough
def test_no_peak_of_many_random_systems_is_missed():
    assert judged_on_grids(range(1000)) > 900
    assert judged_exactly(range(4000, 4250)) > 225
