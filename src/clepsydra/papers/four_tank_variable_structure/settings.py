"""What the settings that are not printed decide: derivative action, gains, and M and P of (10).

The document names the paper that has its PID settings, prints no number of them, and neither a
weight nor a filter of the setpoint, so that those have no row.
"""

from __future__ import annotations

import itertools

import numpy as np

from clepsydra.controllers.virtual_input import VirtualAntiWindup
from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.decoupled import (
    LIMITS,
    READING,
    Setting,
    at_limit,
    at_limits,
    filled_with,
    shares_at_limit,
)
from clepsydra.papers.four_tank_variable_structure.filling import HIGH, PLACE
from clepsydra.papers.four_tank_variable_structure.readings import USUAL, both
from clepsydra.papers.four_tank_variable_structure.rig import fill, in_volts
from clepsydra.papers.row import Row

#: Td in Ti: half of Ziegler and Nichols' and theirs.
DERIVATIVES = (0.125, 0.25)
#: Of K and of Ti, in Johansson's.
_TIMES = (0.5, 1.0, 2.0)
_OTHERS = tuple(Setting(gain, time) for gain, time in itertools.product(_TIMES, _TIMES))
_WEIGHTS = (1.0, 0.5, 0.0)
_WAYS: tuple[VirtualAntiWindup, ...] = ("variable_structure", "none")
_LANE = at_limit(USUAL.limit)


def run() -> Found:
    """Fill the tanks with settings other than Johansson's."""
    return (_derivative(), _settings(), _adjustable())


def _derivative() -> Row:
    words, longest = [], 0.0
    for share in DERIVATIVES:
        runs = {
            "after decoupling": [at_limits(way, Setting(derivative=share)) for way in _WAYS],
            "without": [fill(in_volts(way, derivative=share), LIMITS) for way in _WAYS],
        }
        longest = max(longest, *(shares_at_limit(pair[0], pair[1]).max() for pair in runs.values()))
        told = "; ".join(
            f"{reading} " + " against ".join(both(each, "overshoot", lane=_LANE) for each in pair)
            for reading, pair in runs.items()
        )
        words.append(f"Td = Ti/{1 / share:g}: {told}")
    idle = [
        share
        for share in DERIVATIVES
        if not any(
            at_limits("none", Setting(derivative=share)).saturated(pump)[_LANE] for pump in (1, 2)
        )
    ]
    unsaturated = " and ".join(f"Ti/{1 / share:g}" for share in idle)
    line = PRINTED[PLACE, "overshoot with derivative action"]
    line = line.told(unsaturated=unsaturated, longest=longest, reading=READING)
    return line.remark(". ".join(words))


def _settings() -> Row:
    pairs = [[at_limits(way, each) for way in _WAYS] for each in _OTHERS]
    ranges = [
        f"{min(found):.1f} to {max(found):.1f}"
        for runs in zip(*pairs, strict=True)
        for found in [[run.overshoot(tank)[_LANE] for run in runs for tank in (1, 2)]]
    ]
    longest = max(shares_at_limit(pair[0], pair[1]).max() for pair in pairs)
    least = filled_with("none", _OTHERS, target=HIGH).spilt().min()
    printed = PRINTED[PLACE, "overshoot of the level, conventional PID"].value
    nearest = min(
        (abs(pair[1].overshoot(tank)[_LANE] - printed), -each.time, each, pair[1])
        for each, pair in zip(_OTHERS, pairs, strict=True)
        for tank in (1, 2)
    )
    line = PRINTED[PLACE, "overshoot over the settings"].told(
        nearest=nearest[2],
        overshoot=both(nearest[3], "overshoot", lane=_LANE),
        longest=longest,
        least=least,
        reading=READING,
    )
    return line.remark(f"{ranges[0]} against {ranges[1]}")


def _adjustable() -> Row:
    lanes = [Setting(weight=weight) for weight in _WEIGHTS]
    old, new = filled_with("none", lanes), filled_with("variable_structure", lanes)
    told = [
        f"{share:g}: {both(new, 'overshoot', lane=lane)} against "
        f"{both(old, 'overshoot', lane=lane)}"
        for lane, share in enumerate(1.0 - np.array(_WEIGHTS))
    ]
    line = PRINTED["(11)", "overshoot over the share of m_0 in the proportional part"]
    return line.remark(", ".join(told), reading=READING)
