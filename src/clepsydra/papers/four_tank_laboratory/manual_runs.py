"""Runs of the simulator by hand: constant voltages from empty tanks, for many seeds at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.engine.kernel import Kernel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.papers.four_tank_laboratory.controllers import at_the_simulator, decentralised
from clepsydra.papers.four_tank_laboratory.set_ups import (
    DEVIATIONS,
    Holes,
    Noise,
    SetUp,
    plant,
)

#: Seeds of the pumps' noise.
SEEDS = 16
_EVERY = 10


@dataclass(frozen=True, eq=False)
class ManualRuns:
    """What the levels did, for every seed.

    Parameters
    ----------
    time : ndarray [t]
        [s]
    levels : ndarray [4, seeds, t]
        [cm]
    volts : tuple of float
        Of both pumps.
    off : float
        Share of the second half of the time in which the cut-off had stopped the pumps.
    """

    time: np.ndarray
    levels: np.ndarray
    volts: tuple[float, float]
    off: float

    @property
    def at_last(self) -> np.ndarray:
        """Levels over the last quarter of the time, mean over time and seeds [4] [cm]."""
        return np.asarray(self.levels[:, :, -self.levels.shape[2] // 4 :].mean(axis=(1, 2)))

    @property
    def scatter(self) -> np.ndarray:
        """Standard deviation of one reading in that time [4] [cm]."""
        last = self.levels[:, :, -self.levels.shape[2] // 4 :]
        return np.asarray(last.std(axis=(1, 2)))

    def settled(self, tank: int, band: float) -> float:
        """Return when a level enters a band around its end for good [s], median of the seeds."""
        last = self.levels[tank - 1, :, -self.levels.shape[2] // 4 :].mean(axis=1)
        outside = np.abs(self.levels[tank - 1] - last[:, None]) > band * last[:, None]
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
    samples = round(duration / period)
    # The law stands in manual.
    controller = at_the_simulator(decentralised(set_up), process)
    loop = Loop(controller, linearise(find_equilibrium(process)))
    drawn = np.random.default_rng(7).standard_normal((2, 1 if noise == "none" else seeds, samples))
    given = {
        f"pump_{number}.noise": process.noise[f"pump_{number}.noise"] * DEVIATIONS[noise] * column
        for number, column in zip((1, 2), drawn, strict=True)
    }
    constant = {name: value for name, value in loop.at_rest().items() if name not in given}
    for number, value in enumerate(volts, start=1):
        constant |= {f"pump_{number}.mode": 0.0, f"pump_{number}.manual": value}
    program = closed_loop(process, controller, substeps=1, constant=constant)
    parameters = loop.law_parameters()
    if plugged:
        parameters |= {f"outlet_{tank}.area": 0.0 for tank in (1, 2, 3, 4)}
        parameters |= {"splitter_1.tank_1": 1.0, "splitter_2.tank_2": 1.0}
    empty = {entry.name: 0.0 for entry in process.motion.contents}
    result = Kernel(program, individual=list(given)).run(
        samples,
        inputs=given,
        state=loop.initial_state() | empty,
        parameters=parameters,
        every=every,
    )
    levels = np.array([result.output(f"tank_{tank}.level") for tank in (1, 2, 3, 4)])
    off = result.output("pump_1.tripped")
    return ManualRuns(
        time=np.arange(levels.shape[2]) * period * every,
        levels=100.0 * levels,
        volts=volts,
        off=float(off[:, off.shape[1] // 2 :].mean()),
    )
