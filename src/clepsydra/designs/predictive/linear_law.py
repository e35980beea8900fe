"""What a predictive law is where it oversteps nothing: a linear one."""

from __future__ import annotations

import numpy as np

from clepsydra.controllers.linear_step_law import LinearStepLaw
from clepsydra.controllers.predictive.prediction import Prediction, TabledObserver


def unbounded_law(
    observer: TabledObserver, prediction: Prediction, errors: np.ndarray, moves: np.ndarray
) -> LinearStepLaw:
    """Return the linear model of a predictive law away from all bounds.

    With v = −K z first of all plans, x̂ = x + M (y − C x) and u = u₋ + v, its states are x, what
    the observer expects, and u₋.

    Parameters
    ----------
    errors, moves : ndarray [q], [m]
        Weights of the squares of errors, and of changes from block to block.

    Examples
    --------
    A level that is where the input was, x⁺ = u, seen exactly: one sample and one move bring it to
    its setpoint, u = r.

    >>> from clepsydra.base.signal import Signal
    >>> one = np.ones((1, 1))
    >>> seen = TabledObserver((Signal("x"),), 0 * one, one, one, one)
    >>> ahead = Prediction((1,), one[None], np.array([[[0.0, -1.0, 1.0]]]), (), *2 * [one[:0]])
    >>> law = unbounded_law(seen, ahead, np.ones(1), np.zeros(1))
    >>> law.D_setpoint.item(), law.D_measurement.item()
    (1.0, 0.0)
    """
    feedback = _first_moves(prediction, errors, moves)
    (N, m), q = observer.input_effect.shape, len(errors)
    of_state, of_setpoints, of_inputs = np.split(-feedback, [N, N + q], axis=1)
    corrected = np.eye(N) - observer.correction @ observer.observation
    by_state, by_inputs = of_state @ corrected, np.eye(m) + of_inputs
    by_measurement = of_state @ observer.correction
    held, moved = observer.transition, observer.input_effect
    return LinearStepLaw(
        A=np.block([[held @ corrected + moved @ by_state, moved @ by_inputs],
                    [by_state, by_inputs]]),
        B_setpoint=np.vstack([moved @ of_setpoints, of_setpoints]),
        B_measurement=np.vstack(
            [held @ observer.correction + moved @ by_measurement, by_measurement]
        ),
        C=np.hstack([by_state, by_inputs]),
        D_setpoint=of_setpoints,
        D_measurement=by_measurement,
    )  # fmt: skip


def _first_moves(prediction: Prediction, errors: np.ndarray, moves: np.ndarray) -> np.ndarray:
    """Return K [m, N + q + m] of v = −K z."""
    blocks, m = len(prediction.blocks), len(moves)
    changes = np.eye(blocks * m) - np.eye(blocks * m, k=-m)
    hessian = np.tensordot(errors, prediction.curves, 1)
    hessian = hessian + changes.T @ np.diag(np.tile(moves, blocks)) @ changes
    gain: np.ndarray = np.linalg.solve(hessian, np.tensordot(errors, prediction.slopes, 1))
    return gain[:m]
