"""Runs of the simulator by hand: constant voltages from empty tanks, for many seeds at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.papers.four_tank_laboratory.controllers import decentralised
from clepsydra.papers.four_tank_laboratory.set_ups import Holes, Noise, SetUp, plant
from clepsydra.papers.four_tank_laboratory.simulator import simulated

#: Seeds of the pumps' noise.
SEEDS = 16
_EVERY = 10


@dataclass(frozen=True, eq=False)
class ManualRuns:
    """What the levels did, for every seed."""

    time: np.ndarray  # [t] [s]
    levels: np.ndarray  # [4, seeds, t] [cm]
    off: float  # share of the second half of the time in which the pumps were cut off

    @property
    def last(self) -> np.ndarray:
        """Levels over the last quarter of the time [4, seeds, t / 4] [cm]."""
        return self.levels[:, :, -self.levels.shape[2] // 4 :]

    @property
    def at_last(self) -> np.ndarray:
        """Their mean over time and seeds [4] [cm]."""
        return np.asarray(self.last.mean(axis=(1, 2)))

    def settled(self, tank: int, band: float) -> float:
        """Return when a level enters a band around its end for good [s], median of the seeds."""
        end = self.last[tank - 1].mean(axis=1, keepdims=True)
        outside = np.abs(self.levels[tank - 1] - end) > band * end
        places = outside.shape[1] - np.argmax(outside[:, ::-1], axis=1)
        return float(np.median(self.time[np.minimum(places, len(self.time) - 1)]))


@cache
def by_hand(
    set_up: SetUp,
    volts: tuple[float, float],
    holes: Holes = "report",
    *,
    duration: float = 1000.0,
    noise: Noise = "three deviations",
    plugged: bool = False,
    seeds: int = SEEDS,
    every: int = _EVERY,
) -> ManualRuns:
    """Run the simulator with both pumps at constant voltages, from empty tanks.

    With `plugged` no hole lets water out, and the valves send all of it to the lower tanks.
    """
    process = plant(set_up, "volts", holes)
    period = process.sampling_period
    given: dict[str, float | np.ndarray] = {}
    for number, value in enumerate(volts, start=1):  # the law stands in manual
        given |= {f"pump_{number}.mode": 0.0, f"pump_{number}.manual": float(value)}
    closed = {f"outlet_{tank}.area": 0.0 for tank in (1, 2, 3, 4)}
    straight = {"splitter_1.tank_1": 1.0, "splitter_2.tank_2": 1.0}
    result = simulated(
        decentralised(set_up),
        process,
        round(duration / period),
        given,
        closed | straight if plugged else {},
        drawn=np.random.default_rng(7),
        seeds=seeds,
        noise=noise,
        every=every,
    )
    levels = np.array([result.output(f"tank_{tank}.level") for tank in (1, 2, 3, 4)])
    off = result.output("pump_1.tripped")
    return ManualRuns(
        time=np.arange(levels.shape[2]) * period * every,
        levels=100.0 * levels,
        off=float(off[:, off.shape[1] // 2 :].mean()),
    )
