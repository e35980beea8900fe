"""The loop transfer function of multiloop PI control with the hold of the samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clepsydra.linear.linear_model import LinearModel


class PiSettings(NamedTuple):
    """Gain [input unit / output unit] and integral time [s] of one PI controller."""

    gain: float
    integral_time: float


class StateSpace(NamedTuple):
    """ẋ = A x + B u, y = C x + D u."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray


def loop_transfer(
    model: LinearModel,
    settings: Sequence[PiSettings],
    sampling_period: float,
    output_sizes: Sequence[float] | None = None,
) -> StateSpace:
    """Return L(s) = G(s) H(s) K(s), loop i from error i to output i.

    K is the diagonal of K_i (1 + 1/(Ti_i s)). H is the delay of half a sampling period that
    sample and hold have on average, as a Padé approximation of second order.

    Parameters
    ----------
    model : LinearModel
        Its i-th input is moved by loop i.
    settings : sequence of PiSettings
    sampling_period : float
        [s]
    output_sizes : sequence of float, optional
        Units for the outputs, so that singular values compare like with like.

    Examples
    --------
    A tank of 50 s and gain 2, K = 3, Ti = 10 s; L(j 0.1) is 6 (1 − j)/(1 + 5 j), without the hold:

    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> A, B, C, D = loop_transfer(tank, [PiSettings(3.0, 10.0)], 1e-6)
    >>> value = (C @ np.linalg.solve(0.1j * np.eye(len(A)) - A, B) + D)[0, 0]
    >>> complex(round(value.real, 2), round(value.imag, 2))
    (-0.92-1.38j)
    """
    gains = np.diag([setting.gain for setting in settings])
    rates = np.diag([setting.gain / setting.integral_time for setting in settings])
    count = len(settings)
    controllers = StateSpace(np.zeros((count, count)), rates, np.eye(count), gains)
    process = StateSpace(model.A, model.B, model.C, model.D)
    loop = series(series(controllers, hold(sampling_period, count)), process)
    if output_sizes is None:
        return loop
    sizes = np.asarray(output_sizes, float)
    return StateSpace(
        loop.A, loop.B * sizes, loop.C / sizes[:, None], loop.D * sizes / sizes[:, None]
    )


def hold(sampling_period: float, channels: int) -> StateSpace:
    """Return the second-order Padé approximation of e^(−s T/2) on each channel.

    (1 − sθ/2 + s²θ²/12)/(1 + sθ/2 + s²θ²/12) with θ = T/2.

    Examples
    --------
    >>> A, B, C, D = hold(2.0, 1)
    >>> value = (C @ np.linalg.solve(0.1j * np.eye(2) - A, B) + D)[0, 0]
    >>> round(float(np.angle(value)), 6)
    -0.1
    """
    delay = sampling_period / 2.0
    # In units of the delay; the output is the input less what 1 − e^(−s) leaves.
    A = np.array([[0.0, 1.0], [-12.0, -6.0]]) / delay
    B = np.array([[0.0], [1.0]]) / delay
    C = np.array([[0.0, -12.0]])
    each = np.eye(channels)
    return StateSpace(np.kron(each, A), np.kron(each, B), np.kron(each, C), each)


def series(first: StateSpace, second: StateSpace) -> StateSpace:
    """Return `second` after `first`.

    Examples
    --------
    >>> half = StateSpace(-np.eye(1), np.eye(1), np.eye(1), 0.5 * np.eye(1))
    >>> float(series(half, half).D[0, 0])
    0.25
    """
    upper = np.hstack([first.A, np.zeros((len(first.A), len(second.A)))])
    lower = np.hstack([second.B @ first.C, second.A])
    return StateSpace(
        np.vstack([upper, lower]),
        np.vstack([first.B, second.B @ first.D]),
        np.hstack([second.D @ first.C, second.C]),
        second.D @ first.D,
    )
