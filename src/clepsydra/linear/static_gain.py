"""The static gain of a linear model: what the outputs settle at, for a unit of each input."""

from __future__ import annotations

import numpy as np

from clepsydra.linear.coupled_states import fastest_rate
from clepsydra.linear.dead_time import same_at_the_origin
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.minimal_realisation import minimal_realisation
from clepsydra.linear.poles import integrators
from clepsydra.linear.response import evaluate_transfer

#: What is left of effects that balance, as a share of their sum, is rounding.
_ROUNDING = 1e-13


def static_gain(model: LinearModel) -> np.ndarray:
    """Return G(0) = D - C A⁻¹ B, with infinite entries where the model integrates.

    An entry is +∞ or -∞ where a constant input makes the output grow without bound; the sign
    is that of the growth in the long run. Other entries of a model that integrates are finite:
    each is taken from its own minimal realisation, which leaves out an integrator that the
    input does not fill or the output does not show. Dead times are counted exactly.

    Returns
    -------
    ndarray [q, m]
        [output unit / input unit]

    Examples
    --------
    A tank with an outlet, above a tank without one:

    >>> A, B = np.array([[-0.02, 0.0], [0.02, 0.0]]), np.array([[0.04], [0.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.eye(2), np.zeros((2, 1)),
    ...                     ("upper", "lower"), ("pump",), (), ("level_1", "level_2"))
    >>> static_gain(model).tolist()
    [[2.0], [inf]]
    """
    model = same_at_the_origin(model)
    size = fastest_rate(model.A)
    if not integrators(model.A):
        gain = model.D - model.C @ np.linalg.solve(model.A, model.B)
        effects = np.abs(model.C) @ np.abs(np.linalg.inv(model.A)) @ np.abs(model.B)
        summed = np.abs(model.D) + effects
        return np.where(np.abs(gain) > _ROUNDING * summed, gain, 0.0)
    gain = np.zeros((len(model.outputs), len(model.inputs)))
    for row, column in np.ndindex(*gain.shape):
        B, C, D = model.B[:, [column]], model.C[[row]], model.D[[row]][:, [column]]
        gain[row, column] = _element_gain(*minimal_realisation(model.A, B, C, D), size)
    return gain


def _element_gain(A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, size: float) -> float:
    size = max(size, float(np.linalg.norm(A, 2)) if A.size else 0.0)
    if not integrators(A, size):
        return float((D - C @ np.linalg.solve(A, B))[0, 0])
    # Near the origin G is R / s^k, with k the number of integrators: its sign there is that of
    # the growth. The eigenvalues of two integrators in series may be off by √ε.
    rates, fastest = np.abs(np.linalg.eigvals(A)), size or 1.0
    moving = rates[rates > 1e-6 * fastest]
    near = 1e-4 * (float(moving.min()) if moving.size else fastest)
    return float(np.copysign(np.inf, evaluate_transfer(A, B, C, D, np.array([near]))[0, 0, 0].real))
