"""The relative gain array, the pairing that it suggests, and the pairing's Niederlinski index."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.linear.assignment import cheapest_assignment
from clepsydra.linear.dead_time import same_at_the_origin
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import integrators, origin_radius, poles
from clepsydra.linear.response import evaluate_transfer, frequency_response
from clepsydra.linear.zeros import zeros

# A pair whose relative gain is not positive costs more than any set of pairs that have one.
_NOT_POSITIVE = 1e9
# Relative gains that agree to so many digits are equal: of two such pairs the first is taken.
_EQUAL = 9
_SINGULAR = 1e-12
# The limit s → 0 is extrapolated from this many points, the farthest at this share of the
# radius of convergence: a truncation error of 1e-13, and points far enough from the integrators.
_POINTS = 5
_NEAR = 1e-2


def relative_gain_array(gain: ArrayLike) -> np.ndarray:
    """Return Λ = G ∘ (G⁻¹)ᵀ, element by element.

    λ_ij is the gain from input j to output i while all other loops are open, divided by that
    gain while they hold their outputs perfectly. For a matrix that is not square the
    pseudo-inverse is taken; unlike the square case the result then depends on the units.

    Parameters
    ----------
    gain : array_like [q, m]
        Real, or complex at one frequency.

    Returns
    -------
    ndarray [q, m]
        [1]; rows and columns of a square array sum to one.

    Raises
    ------
    InputError
        An entry is not finite, or the matrix is singular: then some combination of the outputs
        does not answer to the inputs at all, and relative gains are infinite.

    References
    ----------
    E. H. Bristol, On a new measure of interaction for multivariable process control, IEEE
    Transactions on Automatic Control 11(1), 1966, 133-134, doi 10.1109/TAC.1966.1098266.

    Examples
    --------
    >>> relative_gain_array([[2.0, 1.0], [1.0, 2.0]]).round(6).tolist()
    [[1.333333, -0.333333], [-0.333333, 1.333333]]
    """
    gains = np.atleast_2d(np.asarray(gain))
    place = "relative gain array, gain"
    if not np.all(np.isfinite(gains)):
        raise InputError(
            place, gains.tolist(), "finite gains", "use relative_gains(model) where tanks integrate"
        )
    # Rows and columns of length one: units must not decide whether the matrix is singular.
    rows = np.linalg.norm(gains, axis=1, keepdims=True)
    scaled = gains / np.where(rows > 0.0, rows, 1.0)
    columns = np.linalg.norm(scaled, axis=0, keepdims=True)
    scaled = scaled / np.where(columns > 0.0, columns, 1.0)
    singular_values = np.linalg.svd(scaled, compute_uv=False)
    if not singular_values.size or singular_values[-1] <= _SINGULAR * singular_values[0]:
        remedy = "the outputs cannot be set independently; choose other outputs or inputs"
        raise InputError(place, gains.tolist(), "a matrix of full rank", remedy)
    if gains.shape[0] == gains.shape[1]:
        return np.asarray(scaled * np.linalg.inv(scaled).T)
    return np.asarray(gains * np.linalg.pinv(gains).T)


def relative_gains(model: LinearModel) -> np.ndarray:
    """Return the relative gain array of a model at steady state.

    Where the model integrates, G(0) is infinite but Λ has a limit as s → 0; it is found by
    Richardson extrapolation along the positive real axis. Dead times are counted exactly.

    Returns
    -------
    ndarray [q, m]

    Raises
    ------
    InputError
        The static gain is singular.

    Examples
    --------
    Two tanks without an outlet, one of them fed by both pumps:

    >>> B = np.array([[1.0, 0.5], [0.0, 1.0]])
    >>> model = LinearModel(np.zeros((2, 2)), B, np.zeros((2, 0)), np.eye(2), np.zeros((2, 2)),
    ...                     ("a", "b"), ("u", "v"), (), ("y", "z"))
    >>> relative_gains(model).round(6)
    array([[1., 0.],
           [0., 1.]])
    """
    model = same_at_the_origin(model)
    if not integrators(model.A):
        return relative_gain_array(model.D - model.C @ np.linalg.solve(model.A, model.B))
    # Λ is a power series in s as far as the nearest pole or zero that is not at the origin.
    rates = np.abs(np.concatenate([poles(model), zeros(model)]))
    moving = rates[rates > origin_radius(model.A)]
    near = _NEAR * (float(moving.min()) if moving.size else 1.0)
    points = near / 2.0 ** np.arange(_POINTS)
    gains = evaluate_transfer(model.A, model.B, model.C, model.D, points)
    table = [relative_gain_array(gain) for gain in gains]
    for order in range(1, _POINTS):
        weight = 2.0**order
        table = [
            (weight * nearer - farther) / (weight - 1.0) for farther, nearer in pairwise(table)
        ]
    return table[0]


def suggest_pairing(
    relative_gain: ArrayLike,
    outputs: Sequence[str],
    inputs: Sequence[str],
    avoided: np.ndarray | None = None,
) -> list[tuple[str, str]]:
    """Pair each output with the input that suits it best, over all possible pairings.

    Bristol's rules: pairs with positive relative gains, and these as close to one as can be.
    The pairing with the smallest sum of |1 - λ| is taken, and a pair with λ ≤ 0, or one to be
    avoided, only where no pairing does without. With fewer inputs than outputs some outputs stay
    without a partner.

    Parameters
    ----------
    relative_gain : array_like [q, m]
    outputs, inputs : sequence of str
        Names of the rows and of the columns.
    avoided : ndarray [q, m] of bool, optional
        Pairs to be avoided for another reason.

    Returns
    -------
    list of (output, input)
        In the order of the outputs.

    References
    ----------
    E. H. Bristol, doi 10.1109/TAC.1966.1098266.

    Examples
    --------
    >>> suggest_pairing([[-0.64, 1.64], [1.64, -0.64]], ["level_1", "level_2"], ["a", "b"])
    [('level_1', 'b'), ('level_2', 'a')]
    """
    gains = np.real(np.atleast_2d(np.asarray(relative_gain)))
    if gains.shape != (len(outputs), len(inputs)):
        raise ValueError(f"relative gains {gains.shape} for {len(outputs)}×{len(inputs)} names")
    cost = np.round(np.abs(1.0 - gains), _EQUAL) + _NOT_POSITIVE * (gains <= 0.0)
    if avoided is not None:
        cost += _NOT_POSITIVE * avoided
    return [(outputs[row], inputs[column]) for row, column in _cheapest_assignment(cost)]


def _cheapest_assignment(cost: np.ndarray) -> list[tuple[int, int]]:
    rows, columns = cost.shape
    if rows > columns:
        return sorted((row, column) for column, row in _cheapest_assignment(cost.T))
    if columns <= 6:  # at most 720 choices, of which the first is taken where several are best
        every = np.arange(rows)
        best = min(permutations(range(columns), rows), key=lambda p: cost[every, list(p)].sum())
        return list(enumerate(best))
    return cheapest_assignment(cost)


def relative_gain_response(model: LinearModel, omegas: ArrayLike) -> np.ndarray:
    """Return Λ(jω) = G ∘ (G⁻¹)ᵀ at each frequency, exact with dead time.

    Near the crossover of the loops it should be close to one on the pairs that are chosen;
    what it is at rest matters only to integral action.

    Parameters
    ----------
    omegas : array_like [l]
        [rad/s]

    Returns
    -------
    ndarray [l, q, m], complex
        [1]

    Raises
    ------
    InputError
        A frequency is not finite or is a pole (use `relative_gains` for the limit at zero), or
        G is singular there: the frequency is a zero.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, chapter
    3.
    """
    frequencies = np.atleast_1d(np.asarray(omegas, float))
    arrays = []
    for frequency, gain in zip(frequencies, frequency_response(model, frequencies), strict=True):
        try:
            arrays.append(relative_gain_array(gain))
        except InputError:
            where = f"relative gain array, ω = {frequency:.6g} rad/s"
            remedy = "leave the frequency out: some combination of the outputs answers to no input"
            raise InputError(where, gain.tolist(), "a response of full rank", remedy) from None
    return np.array(arrays).reshape(len(frequencies), len(model.outputs), len(model.inputs))


def niederlinski_index(
    gain: ArrayLike,
    pairing: Sequence[tuple[str, str]],
    outputs: Sequence[str],
    inputs: Sequence[str],
) -> float:
    """Return N = det G / Π g_ii with the paired elements on the diagonal.

    With integral action in every loop and N < 0 the closed loop is unstable, however the loops
    are tuned (for a stable process with proper rational loops). N > 0 is necessary only; for
    two loops it says the same as a positive relative gain, since N = 1/λ.

    Parameters
    ----------
    gain : array_like [q, m]
        G(0) [output unit / input unit].
    outputs, inputs : sequence of str
        Names of the rows and of the columns of `gain`.

    Returns
    -------
    float
        [1]; infinite where a paired element is zero.

    Raises
    ------
    InputError
        A gain of the paired signals is not finite: the process integrates.

    References
    ----------
    A. Niederlinski, A heuristic approach to the design of linear multivariable interacting
    control systems, Automatica 7(6), 1971, 691-701.

    Examples
    --------
    >>> pairs = [("level_1", "pump_1"), ("level_2", "pump_2")]
    >>> niederlinski_index([[2.0, 1.0], [1.0, 2.0]], pairs, ("level_1", "level_2"),
    ...                    ("pump_1", "pump_2"))
    0.75
    """
    gains = np.asarray(gain, float)
    rows = [list(outputs).index(output) for output, _ in pairing]
    columns = [list(inputs).index(name) for _, name in pairing]
    paired = gains[np.ix_(rows, columns)]
    if not np.all(np.isfinite(paired)):
        remedy = "the index is defined for a process that does not integrate"
        raise InputError("Niederlinski index, gain", paired.tolist(), "finite static gains", remedy)
    diagonal = np.diag(paired)
    if np.any(diagonal == 0.0):
        return float("inf")
    # Row by row, so that large or small units cannot overflow the product.
    return float(np.linalg.det(paired / diagonal[:, None]))
