"""Poles and time constants of a linear model."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.coupled_states import balanced_groups, fastest_rate
from clepsydra.linear.linear_model import LinearModel, refuse_delays

# A root closer to the origin than this share of the fastest rate stands at the origin.
ORIGIN = 1e-10
# A singular value below this share of the fastest rate is rounding.
_SINGULAR = 1e-12


def poles(model: LinearModel) -> np.ndarray:
    """Return the eigenvalues of A, the rightmost (slowest, or least stable) first.

    Every state of the model counts, also one that the inputs do not move or the outputs do
    not show. Integrators stand at zero exactly, see `integrators`.

    Returns
    -------
    ndarray [n], complex
        [rad/s]

    Raises
    ------
    InputError
        The model has dead time: it may have infinitely many poles.

    Examples
    --------
    >>> A, one = np.diag([-0.1, -0.02]), np.ones((2, 1))
    >>> model = LinearModel(A, one, one[:, :0], one.T, np.zeros((1, 1)),
    ...                     ("a", "b"), ("u",), (), ("y",))
    >>> poles(model).real
    array([-0.02, -0.1 ])
    """
    refuse_delays(model.delays, "poles")
    rates = np.linalg.eigvals(model.A)
    rates[np.argsort(np.abs(rates))[: integrators(model.A)]] = 0.0
    return rightmost_first(rates)


def integrators(A: np.ndarray, size: float | None = None) -> int:
    """Return how many poles stand at the origin, from singular values.

    Eigenvalues are less sure: rounding splits two integrators in series into ±√ε, a stable and
    an unstable pole. Here the null space is taken out, then that of what remains, until what
    remains is regular; of each group of states that act on each other by itself, in units in
    which their couplings compare, since what acts one way only is no rate of a mode.

    Parameters
    ----------
    A : ndarray [n, n]
        [1/s]
    size : float, optional
        For an A whose states compare already, as of a minimal realisation: the rate [1/s] beside
        which rounding is judged.

    Examples
    --------
    >>> integrators(np.array([[1.0, -1.0], [1.0, -1.0]]))
    2
    """
    if size is not None:
        return _nullity(A, _SINGULAR * size)
    groups = balanced_groups(A)
    size = max((float(np.linalg.norm(group, 2)) for group in groups), default=0.0)
    return sum(_nullity(group, _SINGULAR * size) for group in groups)


def _nullity(remaining: np.ndarray, nothing: float) -> int:
    """Return how many eigenvalues are zero, by singular values that are no more than nothing."""
    n = len(remaining)
    while len(remaining):
        _, sizes, directions = np.linalg.svd(remaining)
        rank = int(np.sum(sizes > nothing))
        if rank == len(remaining):
            break
        regular = directions[:rank]
        remaining = regular @ remaining @ regular.T
    return n - len(remaining)


def time_constants(model: LinearModel) -> np.ndarray:
    """Return T = -1/Re(p) of each pole p, in the order of `poles`.

    It is the time in which the mode shrinks to 1/e; infinite for a pole on the imaginary axis
    (an integrator, or an oscillation without damping), negative for an unstable one, where it
    is the time of growth.

    Returns
    -------
    ndarray [n]
        [s]
    """
    rates = poles(model)
    marginal = np.abs(rates.real) <= origin_radius(model.A)
    return np.where(marginal, np.inf, -1.0 / np.where(marginal, 1.0, rates.real))


def rightmost_first(roots: np.ndarray) -> np.ndarray:
    """Sort roots by falling real part, conjugates with the positive imaginary part first.

    Examples
    --------
    >>> rightmost_first(np.array([-2.0, 1.0, -0.5])).real
    array([ 1. , -0.5, -2. ])
    """
    roots = np.asarray(roots, complex)
    return roots[np.lexsort((-roots.imag, -roots.real))]


def origin_radius(A: np.ndarray) -> float:
    """Return how close to the origin a root of a system with this A counts as zero [rad/s].

    Examples
    --------
    >>> origin_radius(np.array([[-0.02]]))
    2e-12
    """
    return ORIGIN * fastest_rate(A)
