"""Plants drawn from the uncertainty of their parameters, each known from its number alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.engine.philox import WORD, philox
from clepsydra.engine.white_noise import key_of, stream_of
from clepsydra.process.distribution import LEAST_SHARE
from clepsydra.process.equations import Equations
from clepsydra.process.spread import Spread
from clepsydra.process.uncertainty import Uncertainty

#: What the last word of a counter says it counts: pairs of draws, beside what noise and
#: `clepsydra.process.drawn` count.
_PAIRS = 3
#: Counters that are made at a time, so that they stay in the cache.
_AT_A_TIME = 8192
#: A unit number is the middle of one of 2⁵² equal parts, which is a number of its own.
_PART = 2.0**-52


def unit_numbers(seed: int, streams: Sequence[str], numbers: np.ndarray) -> np.ndarray:
    """Return numbers that are uniform in (0, 1), by name and number of the draw alone.

    A name keeps its numbers whatever others come or go, and a draw has its own whichever else
    are made: draw n takes two words of block n // 2 of its stream (`philox`), the first two where
    n is even.

    Parameters
    ----------
    seed : int
        Not negative.
    streams : sequence of str
        Names of parameters.
    numbers : ndarray of int
        Of the draws, each from 0 to 2⁶³ − 1.

    Returns
    -------
    ndarray
        [streams, draws]

    Raises
    ------
    InputError
        The seed is no whole number from 0.

    Examples
    --------
    >>> many = unit_numbers(1, ["tank_1.area", "pump_1.gain"], np.arange(1, 1000))
    >>> bool(many[1, 6] == unit_numbers(1, ["pump_1.gain"], np.array([7]))[0, 0])
    True
    """
    key = key_of(seed)
    numbers = np.asarray(numbers, dtype=np.uint64)
    blocks, place = np.unique(numbers >> np.uint64(1), return_inverse=True)
    column = 2 * place + (numbers & np.uint64(1)).astype(np.int64)
    pairs = np.empty((len(blocks), 2))
    found = np.empty((len(streams), len(numbers)))
    for row, name in enumerate(streams):
        stream = stream_of(name)
        for low in range(0, len(blocks), _AT_A_TIME):
            some = blocks[low : low + _AT_A_TIME]
            words = philox((some & WORD, some >> 32, stream, _PAIRS), key)
            for half, (upper, lower) in enumerate((words[:2], words[2:])):
                part = (np.asarray(upper) << np.uint64(20)) | (np.asarray(lower) >> np.uint64(12))
                pairs[low : low + _AT_A_TIME, half] = (part + 0.5) * _PART
        found[row] = pairs.ravel()[column]
    return found


def draw_parameters(
    process: Equations, uncertainty: Uncertainty, seed: int, numbers: np.ndarray
) -> dict[str, np.ndarray]:
    """Return what varies of drawn plants.

    Draw 0 is the plant itself; draws that are of the distribution count from 1.

    Parameters
    ----------
    process : Equations
        With the values about which they vary.
    uncertainty : Uncertainty
        Of it, or another one of the same names.
    seed : int
        Not negative.
    numbers : ndarray of int
        Of the draws, not negative.

    Returns
    -------
    dict
        Parameter, or disturbance that is named, to its values [draws] in SI; what is missing
        stands at its value.

    Raises
    ------
    InputError
        The seed is no whole number from 0, or a distribution leads to where its parameter cannot
        be.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> areas = draw_parameters(process, process.uncertainty, 1, np.arange(1000))["tank_1.area"]
    >>> areas[0].item(), *(round(float(end) / 0.0028, 2) for end in (areas.min(), areas.max()))
    (0.0028, 0.9, 1.1)
    """
    spread = uncertainty.about(process)
    numbers = np.asarray(numbers)
    drawn = values_at(spread, unit_numbers(seed, spread.streams, numbers))
    itself = numbers == 0
    return {
        name: np.where(itself, spread.signals[name].initial, each) for name, each in drawn.items()
    }


def values_at(spread: Spread, unit: np.ndarray) -> dict[str, np.ndarray]:
    """Return the values of everything that varies at given unit numbers, as those of a design.

    Correlated parameters are joined by a Gaussian copula: their unit numbers are made normal, z,
    and those of L z taken, with L Lᵀ the matrix of correlation.

    Parameters
    ----------
    unit : ndarray
        Inside of (0, 1), by the streams of the spread [streams, draws].

    Returns
    -------
    dict
        Name to values [draws], SI.

    References
    ----------
    R. B. Nelsen, An Introduction to Copulas, 2nd ed., Springer, 2006, section 2.3,
    doi:10.1007/0-387-28678-0.
    """
    joined = dict(zip(spread.streams, _correlated(spread, unit), strict=True))
    return {
        name: each.quantile(joined[spread.stream(name)])
        for name, each in spread.distributions.items()
    }


def _correlated(spread: Spread, unit: np.ndarray) -> np.ndarray:
    """Return unit numbers of which those of correlated parameters hang on each other."""
    if not spread.roots:
        return unit
    from scipy.special import ndtr, ndtri

    found = unit.copy()
    for rows, root in spread.roots:
        normal = [ndtri(unit[row]) for row in rows]
        for place, row in enumerate(rows):
            # Added up one by one: a product of matrices rounds a draw by how many there are.
            mixed = root[place, 0] * normal[0]
            for other in range(1, place + 1):
                mixed = mixed + root[place, other] * normal[other]
            found[row] = np.clip(ndtr(mixed), LEAST_SHARE, 1.0 - LEAST_SHARE)
    return found
