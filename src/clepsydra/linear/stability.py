"""Whether a linear model is stable, decided also with dead time."""

from __future__ import annotations

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.linear_model import InternalDelays, LinearModel
from clepsydra.linear.poles import origin_radius, poles
from clepsydra.linear.response import characteristic_matrices

# Between two neighbours on the axis log f may change by this much, and differ by half of it
# from a straight line in the middle.
_STEP = 0.4
# A root of f nearer to the imaginary axis than this share of the frequency stands on it.
_NEAREST = 1e-9
_MOST_POINTS = 400_000
_PHASES = 4096
# Below this share of the radius nothing but a root at the origin is expected.
_SLOWEST = 1e-6


def asymptotically_stable(model: LinearModel) -> bool:
    """Tell whether every motion of a model dies out when it is left alone.

    Every state counts, also one that the inputs do not move or the outputs do not show. Without
    dead time the poles decide. With dead time their number in the right half-plane does, counted
    by the argument principle along the imaginary axis (see `unstable_roots`). A root on the
    axis, to a share of 1e-9 of its frequency, is not stable.

    Raises
    ------
    InputError
        It cannot be decided: delayed signals feed each other at once with gains that may or may
        not be too large, or the dead times are too long beside the fastest rate.

    Examples
    --------
    The tank 1/(s + k e^(-s)) is stable while k < π/2:

    >>> from clepsydra.linear.linear_model import InternalDelays
    >>> one, none = np.eye(1), np.zeros((1, 0))
    >>> for k in (1.57, 1.58):
    ...     late = InternalDelays(np.ones(1), -k * one, one, 0.0 * one, none, 0.0 * one, 0.0 * one)
    ...     asymptotically_stable(LinearModel(0.0 * one, one, none, one, 0.0 * one,
    ...                                       ("h",), ("u",), (), ("y",), delays=late))
    True
    False
    """
    if model.delays is None:
        return bool(np.all(poles(model).real < -origin_radius(model.A)))
    return unstable_roots(model) == 0


def unstable_roots(model: LinearModel) -> int | None:
    """Return how many poles of a model with dead time stand in the right half-plane.

    The poles are the roots of f(s) = det M(s) / Π(s + a_i), with M the characteristic matrix of
    the model and a_i > 0. With M = I - N(s) beyond a radius R that follows from the sizes of
    the matrices, all roots in question lie within R, and the phase of f along the axis from 0 to
    jR counts them. The points on the axis are halved until log f is resolved between them.

    Parameters
    ----------
    model : LinearModel
        With dead time.

    Returns
    -------
    int or None
        None where there is no finite number: a root stands on the imaginary axis, or delayed
        signals that feed each other at once (a difference equation) do not die out.

    References
    ----------
    J. K. Hale and S. M. Verduyn Lunel, Introduction to Functional Differential Equations, 1993,
    doi 10.1007/978-1-4612-4342-7, chapter 9, for the difference equation.
    """
    delays = model.delays
    assert delays is not None
    if not _difference_equation_dies_out(delays):
        return None
    # Beyond R every eigenvalue of N is smaller than one, wherever the phases of e^(-sτ) stand.
    sizes = np.abs(model.A) + np.abs(delays.to_states) @ np.linalg.solve(
        np.eye(len(delays.times)) - np.abs(delays.through), np.abs(delays.from_states)
    )
    radius = 2.0 * _spectral_radius(sizes)
    if not len(model.A):
        return 0
    if radius == 0.0:
        return None  # every state integrates
    rates = np.maximum(np.abs(np.linalg.eigvals(model.A)), 1e-3 * radius)
    phase = _phase_along_the_axis(model, rates, _first_points(model, delays, radius))
    if phase is None:
        return None
    return round((_phase_at_the_end(model, delays, rates, radius) - phase) / np.pi)


def _phase_along_the_axis(
    model: LinearModel, rates: np.ndarray, omegas: np.ndarray
) -> float | None:
    """Return by how much the phase of f rises along the points; None where f has a root there."""
    points = _characteristic(model, rates, omegas)
    if not np.all(np.isfinite(points)):
        return None
    low, high, phase, seen = points[:, :-1], points[:, 1:], 0.0, len(omegas)
    while low.size:
        middle = _characteristic(model, rates, (low[0] + high[0]).real / 2.0)
        if not np.all(np.isfinite(middle)):
            return None
        first, second = (
            (after[2] - before[2]) + 1j * np.angle(after[1] / before[1])
            for before, after in ((low, middle), (middle, high))
        )
        resolved = (np.abs(first + second) < _STEP) & (np.abs(first - second) < _STEP / 2.0)
        phase += float((first + second)[resolved].imag.sum())
        low, middle, high = (each[:, ~resolved] for each in (low, middle, high))
        if np.any((high - low)[0].real < _NEAREST * high[0].real):
            return None
        seen += len(resolved)
        if seen > _MOST_POINTS:
            raise _undecidable(f"a loop resolved by {_MOST_POINTS} frequencies")
        low, high = np.hstack([low, middle]), np.hstack([middle, high])
    return phase


def _characteristic(model: LinearModel, rates: np.ndarray, omegas: np.ndarray) -> np.ndarray:
    """Return ω, and f(jω) as a unit number and the logarithm of its size, -∞ at a root."""
    points = 1j * omegas
    units, sizes = np.linalg.slogdet(characteristic_matrices(model, points)[0])
    below = points[:, None] + rates
    sizes = sizes - np.log(np.abs(below)).sum(axis=1)
    return np.stack([omegas, units / np.prod(below / np.abs(below), axis=1), sizes])


def _first_points(model: LinearModel, delays: InternalDelays, radius: float) -> np.ndarray:
    """Return points from 0 to R, close enough for the dead times and for every decade."""
    turns = radius * float(delays.times.sum())
    steady = np.linspace(0.0, radius, 2 + min(int(8.0 * turns), _MOST_POINTS // 4))
    decades = np.geomspace(_SLOWEST * radius, radius, 300)
    return np.unique(np.concatenate([steady, decades]))


def _phase_at_the_end(
    model: LinearModel, delays: InternalDelays, rates: np.ndarray, radius: float
) -> float:
    """Return the phase of f at jR by the way round in the right half-plane.

    There f = det(I - e^(-sτ) through) det(I - N(s)) Π s/(s + a_i), and each factor is one minus
    numbers smaller than one, whose phase is between ±π/2 all the way.
    """
    late = np.exp(-1j * radius * delays.times)[:, None]
    difference = late * delays.through
    inner = model.A + delays.to_states @ np.linalg.solve(
        np.eye(len(delays.times)) - difference, late * delays.from_states
    )
    small = np.concatenate(
        [np.linalg.eigvals(difference), np.linalg.eigvals(inner / (1j * radius))]
    )
    return float(np.angle(1.0 - small).sum() + np.arctan(rates / radius).sum())


def _difference_equation_dies_out(delays: InternalDelays) -> bool:
    """Tell whether w = through z, z = w later, dies out for all dead times near the given ones."""
    if _spectral_radius(np.abs(delays.through)) < 1.0:
        return True
    turns = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (_PHASES, len(delays.times)))
    sampled = np.linalg.eigvals(np.exp(1j * turns)[:, :, None] * delays.through)
    if np.abs(sampled).max() >= 1.0 - 1e-12:
        return False
    raise _undecidable("delayed signals that feed each other at once with smaller gains")


def _spectral_radius(matrix: np.ndarray) -> float:
    return float(np.abs(np.linalg.eigvals(matrix)).max()) if matrix.size else 0.0


def _undecidable(expected: str) -> InputError:
    return InputError(
        "stability with dead time",
        "undecided",
        expected,
        "approximate the dead time by clepsydra.linear.dead_time.without_dead_time(model, order)",
    )
