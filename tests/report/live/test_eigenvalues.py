"""Eigenvalues in the page, beside those of LAPACK."""

import numpy as np
import pytest
from page_in_node import source
from scipy.optimize import linear_sum_assignment

SCRIPT = f"""
import {{ eigenvalues }} from "{source("live/eigenvalues.ts")}";
answer(given.map(({{ n, values }}) =>
  eigenvalues({{ rows: n, columns: n, values: Float64Array.from(values) }})
    .map((each) => [each.real, each.imaginary])));
"""
EPSILON = np.finfo(float).eps


def found_in_page(node, matrices):
    given = [{"n": len(each), "values": each.ravel().tolist()} for each in matrices]
    return [np.array(each).reshape(-1, 2) @ [1, 1j] for each in node(SCRIPT, given)]


def defective(random, n):
    """Return a matrix with a chain: one eigenvalue several times, and one direction for it."""
    block = np.diag(np.full(n, random.uniform(-1, 1))) + np.diag(random.uniform(0.5, 2, n - 1), 1)
    turned = np.linalg.qr(random.normal(size=(n, n)))[0]
    return turned @ block @ turned.T


def register(random, n):
    """Return a chain of delays whose order is hidden: all its eigenvalues are zero."""
    order = random.permutation(n)
    return np.eye(n, k=1)[np.ix_(order, order)]


def test_each_makes_the_matrix_singular_to_rounding(node):
    """That holds whether or not it is well determined, as that of a chain is not."""
    random = np.random.default_rng(5)
    sizes = random.integers(1, 26, 1000)
    makers = [
        lambda n: random.normal(size=(n, n)),
        lambda n: random.normal(size=(n, n)) * (random.uniform(size=(n, n)) < 0.3),
        lambda n: np.round(random.normal(size=(n, n))),
        lambda n: defective(random, n),
        lambda n: register(random, n),
        lambda n: random.normal(size=(n, 1)) @ random.normal(size=(1, n)),
    ]
    matrices = [makers[place % len(makers)](n) for place, n in enumerate(sizes)]
    for matrix, found in zip(matrices, found_in_page(node, matrices), strict=True):
        n, size = len(matrix), max(np.linalg.norm(matrix, 2), 1e-300)
        pencils = matrix - found[:, None, None] * np.eye(n)
        smallest = np.linalg.svd(pencils, compute_uv=False)[:, -1]
        assert len(found) == n and np.max(smallest) <= 20 * n * EPSILON * size
        assert abs(np.sum(found) - np.trace(matrix)) <= 20 * n * n * EPSILON * size


def test_they_are_those_of_lapack_where_these_are_well_determined(node):
    random = np.random.default_rng(6)
    matrices = [random.normal(size=(n, n)) for n in range(2, 60)]
    matrices += [each + each.T for each in matrices]
    for matrix, found in zip(matrices, found_in_page(node, matrices), strict=True):
        far = np.abs(found[:, None] - np.linalg.eigvals(matrix))
        assert np.max(far[linear_sum_assignment(far)]) < 1e-10 * np.linalg.norm(matrix, 2)


@pytest.mark.parametrize("n", [1, 7, 40])
def test_those_of_a_chain_of_delays_are_exact(n, node):
    """As LAPACK's are: a permutation makes it triangular."""
    (found,) = found_in_page(node, [register(np.random.default_rng(n), n)])
    assert not found.any()


def test_scales_far_apart_cost_no_digits(node):
    random = np.random.default_rng(7)
    matrix, scales = random.normal(size=(9, 9)), 10.0 ** np.arange(-12, 15, 3)
    (found,) = found_in_page(node, [matrix * scales / scales[:, None]])
    far = np.abs(found[:, None] - np.linalg.eigvals(matrix))
    assert np.max(far[linear_sum_assignment(far)]) < 1e-11
