"""The highest point of a curve over frequency, exact with dead time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clepsydra.linear.highest_point import highest_point
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.response import transfer_at
from clepsydra.linear.sensitivity import SensitivityPeak

Curve = Callable[[np.ndarray], np.ndarray]

_PHASES = 2048


def highest(closed: LinearModel, grid: np.ndarray, curve: Curve) -> SensitivityPeak:
    """Return the maximum over frequency of a curve of a stable frequency response.

    The curve is taken at zero, at infinity, and at its highest point between
    (`highest_point`).

    Parameters
    ----------
    closed : LinearModel
        Stable.
    grid : ndarray [l]
        Rising [rad/s], close enough that no peak stands unseen between two of them; see
        `frequency_grid`.
    curve : function
        Of responses [k, q, m] to values [k], both for k frequencies.

    Returns
    -------
    SensitivityPeak
        Its frequency is infinite where the curve only approaches the peak.

    Examples
    --------
    The resonance 1/(s² + 0.2 s + 1):

    >>> from clepsydra.linear.frequency_grid import frequency_grid
    >>> A, B = np.array([[0.0, 1.0], [-1.0, -0.2]]), np.array([[0.0], [1.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.array([[1.0, 0.0]]), np.zeros((1, 1)),
    ...                     ("a", "b"), ("u",), (), ("y",))
    >>> peak = highest(model, frequency_grid(model), lambda values: abs(values[:, 0, 0]))
    >>> round(peak.peak, 6), round(peak.frequency, 3)
    (5.025189, 0.99)
    """

    def values_at(frequencies: np.ndarray) -> np.ndarray:
        return curve(transfer_at(closed, 1j * frequencies))

    # Below a tenth of the grid's lowest frequency the curve is the one at zero.
    between = highest_point(values_at, np.concatenate([grid[:1] / 10.0, grid]))
    return max(
        SensitivityPeak(float(values_at(np.zeros(1))[0]), 0.0),
        SensitivityPeak(*between),
        SensitivityPeak(float(curve(responses_at_infinity(closed)).max()), float("inf")),
        key=lambda found: found.peak,
    )


def responses_at_infinity(model: LinearModel) -> np.ndarray:
    """Return the responses that a model approaches with rising frequency.

    Without a direct way through a dead time that is D. With one, e^(-jωτ) keeps turning: the
    responses at 2048 phases of it (or combinations of phases, for several) stand for all.

    Parameters
    ----------
    model : LinearModel

    Returns
    -------
    ndarray [k, q, m], complex

    Examples
    --------
    >>> one = np.eye(1)
    >>> responses_at_infinity(LinearModel(-one, one, one[:, :0], one, 0.5 * one, ("a",), ("u",),
    ...                                   (), ("y",))).tolist()
    [[[(0.5+0j)]]]
    """
    delays = model.delays
    if delays is None or not (delays.from_inputs.any() and delays.to_outputs.any()):
        return model.D[None].astype(complex)
    r = len(delays.times)
    if r == 1:
        turns = np.linspace(0.0, 2.0 * np.pi, _PHASES, endpoint=False)[:, None]
    else:
        turns = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (_PHASES, r))
    late = np.exp(1j * turns)[:, :, None]
    inner = np.linalg.solve(np.eye(r) - late * delays.through, late * delays.from_inputs)
    return np.asarray(model.D + delays.to_outputs @ inner)
