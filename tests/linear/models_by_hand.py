"""Linear models built by hand for the tests, with dead time and without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from clepsydra import LinearModel
from clepsydra.linear.linear_model import InternalDelays, led_back


def rational(A, B, C, D) -> LinearModel:
    A, B, C, D = (np.atleast_2d(np.asarray(matrix, float)) for matrix in (A, B, C, D))
    n, m, q = len(A), B.shape[1], len(C)
    if A.size == 0:
        n, A, B, C = 0, np.zeros((0, 0)), np.zeros((0, m)), np.zeros((q, 0))
    return LinearModel(
        A, B, np.zeros((n, 0)), C, D,
        tuple(f"x{i}" for i in range(n)), tuple(f"u{i}" for i in range(m)), (),
        tuple(f"y{i}" for i in range(q)),
    )  # fmt: skip


def static(D) -> LinearModel:
    D = np.atleast_2d(np.asarray(D, float))
    return rational(np.zeros((0, 0)), np.zeros((0, D.shape[1])), np.zeros((len(D), 0)), D)


def pure_delay(*times: float) -> LinearModel:
    """One channel for each dead time."""
    r = len(times)
    one, none = np.eye(r), np.zeros
    late = InternalDelays(
        np.array(times), none((0, r)), none((r, 0)), one, none((r, 0)), none((r, r)), one
    )
    names = tuple(f"delayed_{i}" for i in range(r))
    return LinearModel(
        none((0, 0)), none((0, r)), none((0, 0)), none((r, 0)), none((r, r)),
        (), names, (), names, delays=late,
    )  # fmt: skip


def lag(gain: float, time_constant: float) -> LinearModel:
    return rational(-1.0 / time_constant, gain / time_constant, 1.0, 0.0)


def pi(gain: float, integral_time: float) -> LinearModel:
    return rational(0.0, 1.0, gain / integral_time, gain)


def late_feedback(k: float, tau: float, gain: float = 1.0) -> LinearModel:
    """gain/(s + k e^(-s τ)), the dead time inside."""
    one, none = np.eye(1), np.zeros((1, 0))
    late = InternalDelays(np.array([tau]), -k * one, one, 0 * one, none, 0 * one, 0 * one)
    return LinearModel(
        0 * one, gain * one, none, one, 0 * one, ("h",), ("u",), (), ("y",), delays=late
    )


def side_by_side(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return both models: the inputs, states and outputs of one, then of the other."""
    matrices = [[model.A, model.B, model.C, model.D] for model in (first, second)]
    base = rational(*(block_diag(*each) for each in zip(*matrices, strict=True)))
    names = (
        "to_states",
        "from_states",
        "from_inputs",
        "from_disturbances",
        "through",
        "to_outputs",
    )
    late = [delays_of(model) for model in (first, second)]
    blocks = (block_diag(*(getattr(each, name) for each in late)) for name in names)
    return replace(base, delays=InternalDelays(np.concatenate([d.times for d in late]), *blocks))


def delays_of(model: LinearModel) -> InternalDelays:
    """Return its delays, of no signals where it has none."""
    n, m, q = len(model.A), len(model.inputs), len(model.outputs)
    shapes = ((n, 0), (0, n), (0, m), (0, 0), (0, 0), (q, 0))
    return model.delays or InternalDelays(np.zeros(0), *map(np.zeros, shapes))


def led_to_inputs(model: LinearModel, gain: np.ndarray) -> LinearModel:
    """Return the model with u = gain y + a new input."""
    at = model.ports
    return model.with_matrix(led_back(model.matrix, at.u, at.y, gain), model.times)


def series(first: LinearModel, second: LinearModel) -> LinearModel:
    """Return second · first, with the signals of the first and the outputs of the second."""
    m, q, p = len(first.inputs), len(first.outputs), len(second.outputs)
    joined = led_to_inputs(
        side_by_side(first, second), np.eye(m + q, q + p, k=-m) * (np.arange(q + p) < q)
    )
    chosen = joined.select(joined.outputs[q:], joined.inputs[:m])
    return replace(chosen, inputs=first.inputs, outputs=second.outputs)


def feedback(loop: LinearModel) -> LinearModel:
    """Return a loop closed by negative unity feedback."""
    return led_to_inputs(loop, -np.eye(len(loop.inputs)))
