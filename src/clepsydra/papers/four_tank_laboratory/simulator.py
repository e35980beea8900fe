"""The course's simulator, for many seeds at once: constant voltages by hand, and controllers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from clepsydra.engine.kernel import Kernel
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.law_begin import empty_and_cold
from clepsydra.loop.loop import Loop
from clepsydra.papers.four_tank_laboratory import PRINTED
from clepsydra.papers.four_tank_laboratory.controllers import (
    Kind,
    Lagged,
    at_the_simulator,
)
from clepsydra.papers.four_tank_laboratory.set_ups import (
    AREA,
    DEVIATIONS,
    FULL_LEVEL,
    MINIMUM,
    Holes,
    Noise,
    SetUp,
    Units,
    plant,
)
from clepsydra.process.process import Process
from clepsydra.scores.load_response import return_times
from clepsydra.scores.step_response import overshoots, rise_times
from clepsydra.scores.trajectory import first_crossings

#: Seeds of the pumps' noise, with a controller and by hand.
SEEDS, SEEDS_BY_HAND = 128, 16
#: Both references, share of 25 cm.
TARGET = PRINTED["Table 5", "ref1 and ref2"].value / 100.0
#: Poured in one second: 25 % of a tank, ours.
POURED_LEVEL = 0.25 * FULL_LEVEL  # cm


@dataclass(frozen=True)
class Definition:
    """One way to take a score of a stretch of a level, which the report does not define."""

    words: str
    #: Of each seed: time [t] [s], levels in shares of 25 cm [seeds, t].
    of: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def __str__(self) -> str:
        return self.words


#: The usual definition first: rise time [s], overshoot [% of the target], time until back [s].
SCORES: dict[str, tuple[Definition, ...]] = {
    "rise": (
        Definition("from 10 to 90 % of the step", lambda t, y: rise_times(t, y, 0.0, TARGET)),
        Definition("from the step to 15 cm", lambda t, y: first_crossings(t, y, TARGET)),
    ),
    "overshoot": (
        Definition("of the step, up to the first pour", lambda t, y: overshoots(t, y, 0.0, TARGET)),
    ),
    "recovery": (
        Definition(
            "until back within 5 % of 15 cm for good, up to the next pour",
            lambda t, y: return_times(t, y, TARGET, 0.05 * TARGET),
        ),
        Definition(
            "until back within 2 % of 15 cm for good, up to the next pour",
            lambda t, y: return_times(t, y, TARGET, 0.02 * TARGET),
        ),
    ),
}
_TANKS, _PUMPS = (1, 2, 3, 4), (1, 2)


@dataclass(frozen=True, eq=False)
class Runs:
    """What the levels did for every seed, and the pumps for the first one."""

    time: np.ndarray  # [t] [s]
    levels: np.ndarray  # [4, seeds, t] [cm]
    pumps: np.ndarray  # [2, t], in shares of their range

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

    def scored(self, score: str, tank: int, definition: Definition | None = None) -> np.ndarray:
        """Return one of `SCORES` of tank 1 or 2 for each seed: a recovery is of its pour.

        Each third of the time has one event: the step, and the pours into either tank.
        """
        third = len(self.time) // 3
        start = third * tank if score == "recovery" else 0
        part = slice(start, start + third)
        levels = self.levels[tank - 1, :, part] / FULL_LEVEL
        time = self.time[part] - self.time[start]
        return (definition or SCORES[score][0]).of(time, levels)


@cache
def by_hand(
    set_up: SetUp,
    volts: tuple[float, ...],
    holes: Holes = "report",
    *,
    duration: float = 1000.0,
    noise: Noise = "three deviations",
    plugged: bool = False,
    every: int = 10,
) -> Runs:
    """Run the simulator with both pumps at constant voltages, from empty tanks.

    With `plugged` no hole lets water out, and the valves send all of it to the lower tanks.
    """
    program = _program(set_up, "decentralised", "volts", by_hand=True)
    samples = round(duration / program.process.sampling_period)
    given = {f"pump_{number}.manual": volts[number - 1] for number in _PUMPS}
    parameters = _areas(set_up, holes)
    if plugged:
        parameters = dict.fromkeys(parameters, 0.0)
        parameters |= {"splitter_1.tank_1": 1.0, "splitter_2.tank_2": 1.0}
    return _simulated(
        program, samples, given, parameters,
        seed=7, seeds=SEEDS_BY_HAND, noise=noise, every=every,
    )  # fmt: skip


@cache
def runs(
    set_up: SetUp,
    kind: Kind,
    units: Units,
    holes: Holes = "report",
    noise: Noise = "three deviations",
    lagged: Lagged = "all",
    poured: float = POURED_LEVEL,
) -> Runs:
    """Run the simulator with a controller.

    Both references step from the empty tanks to 60 %; when all is at rest water is poured into
    tank 1, and later into tank 2 [cm].
    """
    program = _program(set_up, kind, units, lagged)
    process = program.process
    every = 4 if set_up is MINIMUM else 10
    each, second = (round(time / process.sampling_period) for time in (stretch_of(set_up), 1.0))
    samples = 3 * each
    given: dict[str, float | np.ndarray] = {}
    for tank in (1, 2):
        given[f"level_{tank}.setpoint"] = np.full(samples, target_of(process, f"level_{tank}"))
        pour = given[f"pour_{tank}"] = np.zeros(samples)
        pour[tank * each : tank * each + second] = poured * AREA * 1e-6
    return _simulated(
        program, samples, given, _areas(set_up, holes),
        seed=4, seeds=SEEDS, noise=noise, every=every,
    )  # fmt: skip


def stretch_of(set_up: SetUp) -> float:
    """Return how long a step or a pour has until the next one [s]."""
    return 150.0 if set_up is MINIMUM else 800.0


def target_of(process: Process, name: str) -> float:
    """Return the reference of a level in its unit; its sensor goes on to 120 %."""
    return TARGET * process.signal(name).high / 1.2


@dataclass(frozen=True, eq=False)
class _Program:
    """A loop at the simulator, made ready for any noise."""

    process: Process
    loop: Loop
    kernel: Kernel


_NOISES = tuple(f"pump_{number}.noise" for number in _PUMPS)


@cache
def _program(
    set_up: SetUp, kind: Kind, units: Units, lagged: Lagged = "all", *, by_hand: bool = False
) -> _Program:
    """Return the loop of a controller for any holes, or with it in manual at any voltages."""
    process = plant(set_up, units)
    controller = at_the_simulator(set_up, kind, process, lagged)
    loop = Loop(controller, linearise(find_equilibrium(process)))
    still = {name: value for name, value in loop.at_rest().items() if name not in _NOISES}
    for number in _PUMPS:
        if by_hand:
            still[f"pump_{number}.mode"] = 0.0
            del still[f"pump_{number}.manual"]
        else:
            del still[f"level_{number}.setpoint"], still[f"pour_{number}"]
    program = closed_loop(process, loop.controller, substeps=1, constant=still)
    return _Program(process, loop, Kernel(program, individual=_NOISES))


def _areas(set_up: SetUp, holes: Holes) -> dict[str, float]:
    """Return the parameters of a plant that its holes are."""
    process = plant(set_up, holes=holes)
    names = [f"outlet_{tank}.area" for tank in _TANKS]
    return {name: process.signal(name).initial for name in names}


@cache
def _normal_numbers(seed: int, seeds: int, samples: int) -> np.ndarray:
    """Return standard normal numbers for both pumps, the same ones in every run."""
    return np.random.default_rng(seed).standard_normal((len(_PUMPS), seeds, samples))


def _simulated(
    program: _Program,
    samples: int,
    given: Mapping[str, float | np.ndarray],
    parameters: Mapping[str, float],
    *,
    seed: int,
    seeds: int,
    noise: Noise,
    every: int,
) -> Runs:
    """Run a program from empty tanks, a lane for each seed.

    `given` are inputs, `parameters` stand in the place of the plant's, the noise of both pumps is
    drawn from `seed`, and one sample in `every` is kept.
    """
    process = program.process
    numbers = _normal_numbers(seed, 1 if noise == "none" else seeds, samples)
    deviations = (process.noise[name] * DEVIATIONS[noise] for name in _NOISES)
    columns = [deviation * row for deviation, row in zip(deviations, numbers, strict=True)]
    # Whose states are all declared as zero, and with pumps that stand.
    standing = {f"{pump.name}.last_output": 0.0 for pump in process.inputs}
    found = program.kernel.run(
        samples,
        inputs={**given, **dict(zip(_NOISES, columns, strict=True))},
        state=empty_and_cold(program.loop, standing),
        parameters=program.loop.law_parameters() | dict(parameters),
        every=every,
    )
    levels = 100.0 * np.array([found.output(f"tank_{tank}.level") for tank in _TANKS])
    pumps = [process.signal(f"pump_{number}") for number in _PUMPS]
    return Runs(
        np.arange(levels.shape[2]) * process.sampling_period * every,
        levels,
        np.array([found.output(pump.name)[0] / pump.high for pump in pumps]),
    )
