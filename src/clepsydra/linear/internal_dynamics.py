"""The internal dynamics: what goes on in a process while its outputs are held."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clepsydra.base.words import listed, time_text
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius, rightmost_first
from clepsydra.linear.relative_degree import linear_relative_degrees
from clepsydra.linear.zeros import zeros

#: States that move less than this share of the one that moves most are not named.
_NAMED = 0.2
#: A mode this near to a transmission zero, a share of it, is that zero.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class InternalDynamics:
    """The modes that a linearising feedback hides from the outputs.

    Parameters
    ----------
    modes : ndarray, complex
        [rad/s], rightmost first: the transmission zeros, and what no output shows.
    directions : ndarray [n, modes], complex
        How the states move in each mode [state unit].
    stable : bool
        Every mode dies away.
    words : str
        What follows, a sentence for the reader.
    """

    modes: np.ndarray
    directions: np.ndarray
    stable: bool
    words: str


def internal_dynamics(model: LinearModel) -> InternalDynamics:
    """Find what moves in a process while a feedback holds its outputs, near an operating point.

    With r_j the relative degree of output j, the feedback u = E⁻¹ (v − L) makes
    A − B E⁻¹ [c_j A^r_j] of the linear model. The states with c_j A^k x = 0, k < r_j, are the
    ones that the outputs do not show, and stay among themselves: their modes are the
    transmission zeros, and the modes that no output shows. A decoupling matrix that is not
    singular says nothing about them.

    Parameters
    ----------
    model : LinearModel
        With as many outputs as inputs and a relative degree, without dead time.

    Raises
    ------
    NotLinearisable
        An output has no relative degree.

    References
    ----------
    A. Isidori, Nonlinear Control Systems, 3rd ed., Springer 1995, sections 4.3 and 5.1,
    doi 10.1007/978-1-84628-615-5.

    Examples
    --------
    (3 − s) / ((s + 1) (s + 2)) has a zero in the right half-plane:

    >>> A, B = np.array([[0.0, 1.0], [-2.0, -3.0]]), np.array([[0.0], [1.0]])
    >>> model = LinearModel(A, B, B[:, :0], np.array([[3.0, -1.0]]), np.zeros((1, 1)),
    ...                     ("a", "b"), ("u",), (), ("y",))
    >>> found = internal_dynamics(model)
    >>> found.stable, found.modes.real
    (False, array([3.]))
    """
    sizes = _sizes(model)
    A, B, C = model.A * sizes / sizes[:, None], model.B / sizes[:, None], model.C * sizes
    shown, moved, fed = [], [], []
    for row, degree in zip(C, linear_relative_degrees(model), strict=True):
        for _ in range(degree):
            shown.append(row / np.linalg.norm(row))
            last, row = row, row @ A
        moved.append(last @ B)
        fed.append(row)
    closed = A - B @ np.linalg.solve(np.array(moved), np.array(fed))
    # The null space of what is shown: orthonormal, so that its transpose is its inverse.
    free = np.linalg.svd(np.array(shown))[2][len(shown) :].T
    modes, vectors = np.linalg.eig(free.T @ closed @ free)
    order = [int(np.argmin(np.abs(modes - mode))) for mode in rightmost_first(modes)]
    shares = (free @ vectors)[:, order]
    stable = bool(np.all(modes.real < -origin_radius(A)))
    words = _words(model, rightmost_first(modes), shares, stable)
    return InternalDynamics(rightmost_first(modes), sizes[:, None] * shares, stable, words)


def _sizes(model: LinearModel) -> np.ndarray:
    if model.point is None:
        return np.ones(len(model.states))
    spans = [model.point.process.signal(name).span for name in model.states]
    return np.array([span if math.isfinite(span) and span > 0.0 else 1.0 for span in spans])


def _words(model: LinearModel, modes: np.ndarray, shares: np.ndarray, stable: bool) -> str:
    outputs = listed(model.outputs)
    held = "is" if len(model.outputs) == 1 else "are"
    if not len(modes):
        return f"Nothing moves on its own while {outputs} {held} held."
    slowest, shown = modes[0], zeros(model)
    zero = len(shown) and np.min(np.abs(shown - slowest)) <= _SAME * abs(slowest)
    what = "zero" if zero else "mode"
    moving = np.abs(shares[:, 0])
    named = [
        name
        for name, share in zip(model.states, moving, strict=True)
        if share > _NAMED * moving.max()
    ]
    names, rate = listed(named), f"{slowest.real:.3g} rad/s"
    one = len(named) == 1
    if stable:
        time, come = time_text(-1.0 / slowest.real), "comes" if one else "come"
        return (
            f"While {outputs} {held} held, {names} {come} to rest with a time constant of {time} "
            f"(a {what} at {rate})."
        )
    if slowest.real > origin_radius(model.A):
        time, run = time_text(1.0 / slowest.real), "runs" if one else "run"
        return (
            f"while {outputs} {held} held, {names} {run} away, e times as far every {time} "
            f"(a {what} at +{rate})"
        )
    return f"while {outputs} {held} held, {names} never {'comes' if one else 'come'} to rest"
