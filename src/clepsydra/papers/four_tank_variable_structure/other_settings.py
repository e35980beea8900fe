"""Settings other than Johansson's: on what the claims of the figures hang.

The document names the paper that has its PID settings, and prints no number of them and no m_0 or
p of (10), so that these have no row; the reasons of its claims tell what they decide.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import NamedTuple

from clepsydra.base.words import listed
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    HIGH,
    LANE,
    LIMITS,
    Setting,
    decoupled,
    filled_with,
    shares_at_limit,
)
from clepsydra.papers.four_tank_variable_structure.rig import fill, in_volts

#: Td in Ti: half of Ziegler and Nichols' and theirs.
DERIVATIVES = (0.125, 0.25)
#: Of K and of Ti, in Johansson's.
TIMES = (0.5, 1.0, 2.0)
OTHERS = tuple(Setting(gain, time=time) for gain, time in itertools.product(TIMES, TIMES))


def alike() -> str:
    """Return in words with which settings no pump up to 10 V saturates under either controller."""
    groups = {f"with {gain:g} K": [each for each in OTHERS if each.gain == gain] for gain in TIMES}
    groups |= {
        f"with an ideal derivative action of Td = Ti/{1 / share:g} on the levels": [
            Setting(derivative=share)
        ]
        for share in DERIVATIVES
    }
    groups["with half of the proportional part in m_0 of (10)"] = [Setting(weight=0.5)]
    return listed([words for words, settings in groups.items() if not _saturates(settings)])


def _saturates(settings: Iterable[Setting]) -> bool:
    runs = (decoupled(way, each) for each in settings for way in COMPARED)
    return any(run.saturated(pump)[LANE] > 0.0 for run in runs for pump in (1, 2))


def longest_over_settings() -> float:
    """Return the largest share of the conventional time at a limit, over the nine settings."""
    pairs = ([decoupled(way, each) for way in COMPARED] for each in OTHERS)
    return max(float(shares_at_limit(pair).max()) for pair in pairs)


def longest_with_derivative() -> tuple[float, float]:
    """Return the same with an ideal derivative action after decoupling, a filtered one without."""
    ideal, filtered = (
        max(
            float(shares_at_limit(made(way, share) for way in COMPARED).max())
            for share in DERIVATIVES
        )
        for made in (
            lambda way, share: decoupled(way, Setting(derivative=share)),
            lambda way, share: fill(in_volts(way, derivative=share), LIMITS),
        )
    )
    return ideal, filtered


def least_spilt() -> float:
    """Return what conventional PID spills at least, filled high, over the nine settings [cm³]."""
    return float(filled_with("none", OTHERS, target=HIGH).spilt.sum(axis=1).min())


class Overshoots(NamedTuple):
    """Overshoots of conventional PID over the nine settings, of both levels [%]."""

    least: float
    most: float
    nearest: Setting  # to what is printed
    there: tuple[float, float]


def overshoots(printed: float) -> Overshoots:
    """Return the overshoots of conventional PID, and the setting nearest to a printed one [%].

    Examples
    --------
    >>> found = overshoots(12.0)
    >>> found.nearest.gain, found.nearest.time
    (2.0, 2.0)
    """
    runs = {each: decoupled("none", each) for each in OTHERS}
    found = {
        each: (float(run.overshoot(1)[LANE]), float(run.overshoot(2)[LANE]))
        for each, run in runs.items()
    }
    flat = [value for pair in found.values() for value in pair]
    nearest = min(OTHERS, key=lambda each: max(abs(value - printed) for value in found[each]))
    return Overshoots(min(flat), max(flat), nearest, found[nearest])
