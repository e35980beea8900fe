"""Pumps and outlets other than the controllers assume."""

from __future__ import annotations

import itertools

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    READING,
    READINGS,
    filled_in,
    saturating,
)
from clepsydra.papers.four_tank_variable_structure.rig import Filling, fill, in_nu, plant

_VARIED = ("pump_1.gain", "pump_2.gain", "outlet_1.area", "outlet_2.area")
_SPREAD = 0.2
#: What is compared, and its unit.
_SCORES = {"overshoot": "%", "settling": "s"}


def run() -> Found:
    """Fill the tanks of every corner of ±20 % with both controllers, decoupled and not."""
    corners = np.array(list(itertools.product((1 - _SPREAD, 1 + _SPREAD), repeat=len(_VARIED))))
    parameters = {
        name: plant().signal(name).initial * corners[:, place] for place, name in enumerate(_VARIED)
    }
    lanes = [reading for reading in READINGS for _ in corners]
    everywhere = {name: np.tile(values, len(READINGS)) for name, values in parameters.items()}
    new, old = (
        _worst(filled_in(way, lanes, everywhere), "settling", len(corners)) for way in COMPARED
    )
    slower = next(place for place in saturating() if new[place] > old[place])
    linear = [fill(in_nu(way), parameters=parameters) for way in COMPARED]
    worst = {what: [_worst(run, what, len(corners))[0] for run in linear] for what in _SCORES}
    line = PRINTED["section 6", "worst overshoot and settling time"]
    yield line.remark(
        ", ".join(
            f"{one:.3g} against {other:.3g} {_SCORES[what]}" for what, (one, other) in worst.items()
        ),
        slower=READINGS[slower],
        settling=f"{new[slower]:.0f} against {old[slower]:.0f} s",
        reading=READING,
    )


def _worst(run: Filling, what: str, count: int) -> np.ndarray:
    """Return the worst of a score over the corners of each reading."""
    worse = np.maximum(*(getattr(run, what)(tank) for tank in (1, 2)))
    return np.asarray(worse.reshape(-1, count).max(axis=1))
