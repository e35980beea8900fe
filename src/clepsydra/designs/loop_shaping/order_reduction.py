"""Order reduction: a plant of fewer states whose coprime factors are nearly the same."""

from __future__ import annotations

import numpy as np

from clepsydra.designs.loop_shaping.coprime_factors import CoprimeFactors
from clepsydra.designs.sampled.sampled_system import SampledSystem


def reduced_plant(factors: CoprimeFactors, order: int) -> SampledSystem:
    """Return the plant N_r, M_r of fewer states by balanced truncation of the coprime factors.

    The factors are stable even where the plant integrates or is unstable, so that nothing has to
    be split off first. They are off by at most twice the sum of the Hankel singular values that
    are left out, and their difference is what the robust controller bears: one whose 1/γ is above
    that keeps its stability on the full plant.

    It is that of the sampled system itself, so that the plant keeps having no direct way from
    input to output.

    Parameters
    ----------
    order : int
        From 1 to the order of the plant.

    References
    ----------
    D. Meyer, Fractional balanced reduction: model reduction via a fractional representation,
    IEEE Transactions on Automatic Control 35(12), 1990, 1341-1345; the bound for sampled systems:
    U. Al-Saggaf and G. Franklin, An error bound for a discrete reduced order model of a linear
    multivariable system, ibid. 32(9), 1987, 815-819.

    Examples
    --------
    A lag of 50 samples and one of a quarter of a sample: the second is hardly missed.

    >>> from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
    >>> A, B, C = np.diag([0.98, 0.02]), np.ones((2, 1)), np.array([[0.1, 0.01]])
    >>> found = reduced_plant(coprime_factors(SampledSystem(A, B, C, np.zeros((1, 1)))), 1)
    >>> len(found.A), found.A.round(2)
    (1, array([[0.98]]))
    """
    reached, shown = factors.roots
    left, values, right = np.linalg.svd(shown.T @ reached)
    # A singular vector and its partner may both be turned: the first large number is positive.
    turned = np.array([_sign(column) for column in (reached @ right[:order].T).T])
    scale = turned / np.sqrt(values[:order])
    into = (scale[:, None] * left.T[:order]) @ shown.T
    back = reached @ (right[:order].T * scale)
    A, B, C, _ = factors.system
    a, b, c = into @ A @ back, into @ B, factors.root @ C @ back
    m = factors.plant.B.shape[1]
    return SampledSystem(a - b[:, m:] @ c, b[:, :m], c, factors.plant.D)


def _sign(direction: np.ndarray) -> float:
    large = np.abs(direction) > 0.3 * np.abs(direction).max()
    return 1.0 if direction[np.argmax(large)] > 0.0 else -1.0
