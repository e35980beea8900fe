"""What the settings that are not printed decide: derivative action, gains, and M and P of (10).

The document names the paper that has its PID settings, prints no number of them, and neither a
weight nor a filter of the setpoint, so that those have no row.
"""

from __future__ import annotations

import itertools

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.filling import HIGH, PLACE
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    LANE,
    LIMITS,
    READING,
    Setting,
    both,
    decoupled,
    filled_with,
    shares_at_limit,
)
from clepsydra.papers.four_tank_variable_structure.rig import fill, in_volts
from clepsydra.papers.row import Row

#: Td in Ti: half of Ziegler and Nichols' and theirs.
DERIVATIVES = (0.125, 0.25)
#: Of K and of Ti, in Johansson's.
_TIMES = (0.5, 1.0, 2.0)
_OTHERS = tuple(Setting(gain, time=time) for gain, time in itertools.product(_TIMES, _TIMES))
_WEIGHTS = (1.0, 0.5, 0.0)


def run() -> Found:
    """Fill the tanks with settings other than Johansson's."""
    return (_derivative(), _settings(), _adjustable())


def _derivative() -> Row:
    words, idle, longest = [], [], 0.0
    for share in DERIVATIVES:
        after = [decoupled(way, Setting(derivative=share)) for way in COMPARED]
        without = [fill(in_volts(way, derivative=share), LIMITS) for way in COMPARED]
        runs = {"after decoupling": after, "without": without}
        longest = max(longest, *(shares_at_limit(pair).max() for pair in runs.values()))
        told = "; ".join(
            f"{reading} " + " against ".join(both(each, "overshoot") for each in pair)
            for reading, pair in runs.items()
        )
        words.append(f"Td = Ti/{1 / share:g}: {told}")
        if not any(after[1].saturated(pump)[LANE] for pump in (1, 2)):
            idle.append(f"Ti/{1 / share:g}")
    line = PRINTED[PLACE, "overshoot with derivative action"]
    line = line.told(unsaturated=" and ".join(idle), longest=longest, reading=READING)
    return line.remark(". ".join(words))


def _settings() -> Row:
    pairs = [[decoupled(way, each) for way in COMPARED] for each in _OTHERS]
    ranges = [
        f"{min(found):.1f} to {max(found):.1f}"
        for runs in zip(*pairs, strict=True)
        for found in [[run.overshoot(tank)[LANE] for run in runs for tank in (1, 2)]]
    ]
    longest = max(shares_at_limit(pair).max() for pair in pairs)
    least = filled_with("none", _OTHERS, target=HIGH).spilt().min()
    printed = PRINTED[PLACE, "overshoot of the level, conventional PID"].value
    nearest = min(
        (abs(pair[1].overshoot(tank)[LANE] - printed), -each.time, each, pair[1])
        for each, pair in zip(_OTHERS, pairs, strict=True)
        for tank in (1, 2)
    )
    line = PRINTED[PLACE, "overshoot over the settings"].told(
        nearest=nearest[2],
        overshoot=both(nearest[3], "overshoot"),
        longest=longest,
        least=least,
        reading=READING,
    )
    return line.remark(f"{ranges[0]} against {ranges[1]}")


def _adjustable() -> Row:
    lanes = [Setting(weight=weight) for weight in _WEIGHTS]
    runs = [filled_with(way, lanes) for way in COMPARED]
    told = [
        f"{share:g}: " + " against ".join(both(run, "overshoot", lane=lane) for run in runs)
        for lane, share in enumerate(1.0 - np.array(_WEIGHTS))
    ]
    line = PRINTED["(11)", "overshoot over the share of m_0 in the proportional part"]
    return line.remark(", ".join(told), reading=READING)
