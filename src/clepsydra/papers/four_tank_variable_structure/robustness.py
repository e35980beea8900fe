"""Pumps and outlets other than the controllers assume."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from clepsydra.papers.document import Found
from clepsydra.papers.four_tank_variable_structure import PRINTED
from clepsydra.papers.four_tank_variable_structure.readings import (
    COMPARED,
    OTHERWISE,
    READINGS,
    filled_in,
    saturating,
)
from clepsydra.papers.four_tank_variable_structure.rig import (
    Filling,
    fill,
    in_nu,
    plant,
)
from clepsydra.papers.settling_bands import BANDS

_VARIED = ("pump_1.gain", "pump_2.gain", "outlet_1.area", "outlet_2.area")
_SPREAD = 0.2


def run() -> Found:
    """Fill the tanks of every corner of ±20 % with both controllers, decoupled and not."""
    corners = np.array(list(itertools.product((1 - _SPREAD, 1 + _SPREAD), repeat=len(_VARIED))))
    parameters = {
        name: plant().signal(name).initial * corners[:, place] for place, name in enumerate(_VARIED)
    }
    lanes = [reading for reading in READINGS for _ in corners]
    everywhere = {name: np.tile(values, len(READINGS)) for name, values in parameters.items()}
    coupled = [filled_in(way, lanes, everywhere) for way in COMPARED]
    linear = [fill(in_nu(way), parameters=parameters) for way in COMPARED]

    def worst(runs: Sequence[Filling], band: float) -> list[np.ndarray]:
        return [_worst(partial(run.settling, band=band), len(corners)) for run in runs]

    slow = [worst(coupled, band) for band in BANDS]
    slower = next(
        place for place in saturating() if all(new[place] > old[place] for new, old in slow)
    )
    over, other = (_worst(run.overshoot, len(corners))[0] for run in linear)
    settling = [[each[0] for each in worst(linear, band)] for band in BANDS]
    assert over < other and all(new < old for new, old in settling)
    line = PRINTED["section 6", "worst overshoot and settling time"]
    yield line.remark(
        f"{over:.3g} against {other:.3g} %, "
        + ", ".join(f"{new:.3g} against {old:.3g} s" for new, old in settling),
        slower=READINGS[slower],
        settling=" and ".join(
            f"{new[slower]:.0f} against {old[slower]:.0f} s" for new, old in slow
        ),
        reading=OTHERWISE,
    )


def _worst(score: Callable[[int], np.ndarray], count: int) -> np.ndarray:
    """Return the worst score of a lower level over the corners of each reading."""
    worse = np.maximum(*map(score, (1, 2)))
    return np.asarray(worse.reshape(-1, count).max(axis=1))
