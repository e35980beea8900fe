"""Runs of the simulator with a controller: reference step from empty tanks, then two pours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.controllers import decentralised, robust
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    FULL_LEVEL,
    MINIMUM,
    Holes,
    Noise,
    SetUp,
    Units,
    plant,
)
from clepsydra.papers.four_tank_laboratory.simulator import simulated
from clepsydra.scores.load_response import return_time
from clepsydra.scores.step_response import overshoot, rise_time

Kind = Literal["decentralised", "robust"]

SEEDS = 128
#: Both references, share of 25 cm.
TARGET = PRINTED["Table 5", "ref1 and ref2"].value / 100.0
#: Poured: 25 % of a tank, in one second.
POURED = 0.25 * FULL_LEVEL * AREA * 1e-6  # m³
#: Back within this share of the target counts as recovered; the noise forbids 2 %.
BAND = 0.05
#: Of a stretch of a level: rise time [s], overshoot [% of the target], time until it is back [s].
SCORES: dict[str, Callable[[np.ndarray, np.ndarray], float]] = {
    "rise": lambda time, level: rise_time(time, level, 0.0, TARGET),
    "overshoot": lambda time, level: overshoot(time, level, 0.0, TARGET),
    "recovery": lambda time, level: return_time(time, level, TARGET, BAND * TARGET),
}


@dataclass(frozen=True, eq=False)
class Runs:
    """What both lower levels and both pumps did, for every seed."""

    time: np.ndarray  # [t] [s]
    levels: np.ndarray  # [2, seeds, t], in shares of 25 cm
    pumps: np.ndarray  # the same of 15 V
    pours: tuple[int, int]  # the samples at which water is poured into tank 1 and into tank 2

    def scored(self, score: str, tank: int) -> np.ndarray:
        """Return one of `SCORES` of a tank, 0 or 1, for each seed: a recovery is of its pour."""
        ends = (0, *self.pours, len(self.time))
        first = tank + 1 if score == "recovery" else 0
        part = slice(ends[first], ends[first + 1])
        return np.array([SCORES[score](self.time[part], y[part]) for y in self.levels[tank]])


@cache
def runs(
    set_up: SetUp,
    kind: Kind,
    units: Units,
    holes: Holes = "report",
    noise: Noise = "three deviations",
) -> Runs:
    """Run the simulator with a controller, all seeds in one batch.

    Both references step from the empty tanks to 60 %; when all is at rest 6.25 cm are poured
    into tank 1, and later into tank 2.
    """
    process = plant(set_up, units, holes)
    designed = decentralised(set_up) if kind == "decentralised" else robust(set_up)
    period, every = process.sampling_period, 4 if set_up is MINIMUM else 10
    stretch = 150.0 if set_up is MINIMUM else 800.0
    each, second = round(stretch / period), round(1.0 / period)
    samples = 3 * each
    given: dict[str, float | np.ndarray] = {}
    for tank in (1, 2):
        target = TARGET * process.signal(f"level_{tank}").high / 1.2
        given[f"level_{tank}.setpoint"] = np.full(samples, target)
        pour = given[f"pour_{tank}"] = np.zeros(samples)
        pour[tank * each : tank * each + second] = POURED
    result = simulated(
        designed, process, samples, given, drawn=np.random.default_rng(4), seeds=SEEDS,
        noise=noise, every=every,
    )  # fmt: skip
    levels = np.array([result.output(f"tank_{tank}.level") for tank in (1, 2)])
    highs = [process.signal(f"pump_{number}").high for number in (1, 2)]
    pumps = np.array([result.output(f"pump_{number}") for number in (1, 2)])
    return Runs(
        time=np.arange(levels.shape[2]) * period * every,
        levels=100.0 * levels / FULL_LEVEL,
        pumps=pumps / np.array(highs)[:, None, None],
        pours=(each // every, 2 * each // every),
    )
