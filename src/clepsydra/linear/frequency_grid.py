"""Frequencies at which a linear model is worth looking at."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.dead_time import same_at_the_origin, undisturbed, without_dead_time
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.poles import origin_radius
from clepsydra.linear.zeros import zeros

_PER_DECADE = 60
_BEYOND = 100.0
# The phase of all dead times together turns by this much between two frequencies [rad] ...
_TURN = np.pi / 16.0
# ... as far as this many frequencies reach.
_MOST = 4000
# Around a resonance, in units of its half-width.
_AROUND = np.array([-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 2.0, 4.0, 8.0])
# A root nearer to the axis than this share of its size stands on it, and the grid beside it.
_UNDAMPED = 1e-7
_PADE_ORDER = 4
# Two integrators in series may be off the origin by this many radii.
_AT_ORIGIN = 1e4


def frequency_grid(model: LinearModel) -> np.ndarray:
    """Return frequencies that show all that a model does, from slow to fast.

    Sixty a decade, from a hundredth of the slowest pole, zero or inverse dead time to a hundred
    times the fastest; more around each resonance; and with dead time enough to follow its
    phase, up to 4000 of these. No pole stands on the grid.

    Returns
    -------
    ndarray [l]
        Rising [rad/s], above zero.
    """
    roots, late = _roots(model), float(model.times.sum())
    rates = [*np.abs(roots), *([1.0 / late] if late else [])] or [1.0]
    low, high = min(rates) / _BEYOND, max(rates) * _BEYOND
    count = int(np.ceil(_PER_DECADE * np.log10(high / low))) + 1
    parts = [np.geomspace(low, high, count)]
    ringing = roots[(roots.imag > 0.0) & (np.abs(roots.real) < 0.3 * np.abs(roots))]
    widths = np.maximum(np.abs(ringing.real), 1e-6 * ringing.imag)
    parts.append((ringing.imag[:, None] + widths[:, None] * _AROUND).ravel())
    if late:
        step = _TURN / late
        # Below this frequency the logarithmic grid is the finer one.
        start = step * _PER_DECADE / np.log(10.0)
        parts.append(start + step * np.arange(min(_MOST, max(0.0, (high - start) / step))))
    grid = np.unique(np.concatenate(parts))
    undamped = np.abs(roots[np.abs(roots.real) < _UNDAMPED * np.abs(roots)])
    clear = np.all(np.abs(grid[:, None] - undamped) > _UNDAMPED * grid[:, None], axis=1)
    return grid[(grid >= low) & (grid <= high) & clear]


def _roots(model: LinearModel) -> np.ndarray:
    """Return poles and zeros away from the origin, of rational models like this one."""
    if model.delays is None:
        found = np.concatenate([np.linalg.eigvals(model.A), zeros(model)])
    else:
        found = np.concatenate([np.linalg.eigvals(model.A), _roots(same_at_the_origin(model))])
        with suppress(InputError):  # not well posed at this order: its poles only add points
            approximate = without_dead_time(undisturbed(model), _PADE_ORDER)
            found = np.concatenate([found, np.linalg.eigvals(approximate.A)])
    return found[np.abs(found) > max(_AT_ORIGIN * origin_radius(model.A), 1e-300)]
