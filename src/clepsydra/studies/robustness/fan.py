"""What many drawn plants do over time: at each instant, where shares of them are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from clepsydra.studies.robustness.drawn_loops import DrawnLoops

Array = NDArray[np.float64]

#: The shares of plants that lie below each curve of a fan.
CHANCES = (0.05, 0.25, 0.5, 0.75, 0.95)
#: Draws of a fan, and values of a signal at most, which take 32 MB.
DRAWS, _VALUES = 300, 4_000_000


@dataclass(frozen=True, eq=False)
class Fan:
    """Controlled measurements and inputs of many plants, without what noise adds to a reading.

    Attributes
    ----------
    time : ndarray [records]
        [s]
    every : int
        Samples from one record to the next.
    shares : dict
        Signal to what the shares `CHANCES` of the plants are at most, at each instant by itself
        [5, records], SI.
    on_paper : dict
        Signal to what it does on the plant itself [records], SI.
    draws : int
        Plants that it is of, the first ones: those with a steady state whose loop did not break.
    """

    time: Array
    every: int
    shares: dict[str, Array]
    on_paper: dict[str, Array]
    draws: int


def fan_of(loops: DrawnLoops, draws: int = DRAWS) -> Fan:
    """Return the fan of draws 1, 2, … of a controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.robustness(cl.design.simc(plant), plant, draws=20, sensitivity=False)
    >>> fan = fan_of(found.loops, 20)
    >>> fan.draws, sorted(fan.shares), bool(np.all(np.diff(fan.shares["level_3"], axis=0) >= 0.0))
    (20, ['feed', 'level_3'], True)
    """
    scenario = loops.scenario
    every = math.ceil(scenario.samples * (draws + 1) / _VALUES)
    rows = loops.trajectories(np.arange(draws + 1), every)
    whole = np.logical_and.reduce([np.isfinite(each).all(axis=1) for each in rows.values()])
    whole[0] = False
    records = next(iter(rows.values())).shape[1]
    nothing: Array = np.full((len(CHANCES), records), np.nan)
    period = every * scenario.sampling_period
    return Fan(
        np.asarray(period * np.arange(records), dtype=np.float64),
        every,
        {
            name: np.asarray(np.quantile(each[whole], CHANCES, axis=0)) if whole.any() else nothing
            for name, each in rows.items()
        },
        {name: each[0] for name, each in rows.items()},
        int(whole.sum()),
    )
