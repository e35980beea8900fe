"""How cost grows with the process: chains of tanks, and every process of the catalogue."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from benchmarks.experiments import Disagreement
from benchmarks.measure import Spread, Way, interleave, on_one_core
from clepsydra.engine.kernel import Job, Kernel
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import MotionBlock, motion_at_rest
from clepsydra.loop.open_loop import simulate
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program

CHAINS = (10, 50, 200, 1000)
#: Initial contents of the scenarios of a batch, over those at the operating point.
SPREAD = 0.05
#: Samples over which a kernel is compared with another solution.
_COMPARED = 10
#: Largest relative differences: from the same RK4 steps in NumPy, and from CVODES, whose steps
#: are smaller.
SAME_STEPS, OTHER_STEPS = 1e-12, 1e-6


@dataclass(frozen=True)
class Growth:
    """What one process costs.

    Parameters
    ----------
    name : str
    operations : int
        In the program of one sample, those of a loop once.
    substeps : int
        Integration steps in a sample.
    load, write, compile : float
        Once: to read the file, to write the program, to compile it for a batch [s].
    one_run, batch : Spread
        A sample of one run [s]; a sample of one scenario of a batch [s].
    difference : float
        Largest relative difference from another solution.
    """

    name: str
    operations: int
    substeps: int
    load: float
    write: float
    compile: float
    one_run: Spread
    batch: Spread
    difference: float


def chain_file(tanks: int, folder: Path) -> Path:
    """Write the process file of a chain: a pump fills the first tank, each drains into the next."""
    lines = [
        f'name = "chain-of-{tanks}"', 'sampling_period = "1 s"', 'controlled = ["level"]',
        "[reservoirs.basin]",
        "[pumps.pump]", 'source = "basin"', 'destination = "tank_1"', 'gain = "10 cm^3/(s V)"',
        'range = ["0 V", "10 V"]', 'nominal = "5 V"',
        "[sensors.level]", 'tank = "tank_1"', 'range = ["0 cm", "50 cm"]',
    ]  # fmt: skip
    for number in range(1, tanks + 1):
        below = "basin" if number == tanks else f"tank_{number + 1}"
        lines += [
            f"[tanks.tank_{number}]", 'area = "100 cm^2"', 'height = "50 cm"',
            f"[orifices.outlet_{number}]", f'source = "tank_{number}"',
            f'destination = "{below}"', 'area = "0.5 cm^2"',
        ]  # fmt: skip
    path = folder / f"chain_{tanks}.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def chain_point(path: Path) -> OperatingPoint:
    """Return the operating point of a chain in closed form: every tank passes the pump's flow."""
    process = load_process(path)
    voltage, gain, outlet, gravity = 5.0, 10e-6, 0.5e-4, 9.81
    level = (gain * voltage / outlet) ** 2 / (2 * gravity)
    return OperatingPoint(
        process, np.full(len(process.state), level), np.array([voltage]), np.zeros(0),
        np.array([level]), 0.0,
    )  # fmt: skip


def open_loop_program(point: OperatingPoint, substeps: int) -> Program:
    """Return the program of one sample of a process whose inputs are given."""
    process = point.process
    totals = tuple(signal.name for signal in process.motion.totals)
    motion = MotionBlock(process.motion, process.sampling_period, substeps, totals)
    outside = (*process.inputs, *process.disturbances)
    state = len(motion.state)
    arguments = range(state + len(outside) + len(process.parameters))
    builder = BlockBuilder(len(arguments))
    following = motion.move(builder, arguments[:state], arguments[state:])
    block = builder.finish([*following, *following[: len(process.motion.contents)]])
    return Program(
        process.name, motion.state, outside, process.parameters, process.motion.contents, block
    )


class Scale:
    """The measurements of growth.

    Parameters
    ----------
    rounds : int
    operations : int
        How many operations one timed run has; its samples follow from them.
    folder : Path
        Where process files and kernels are kept.
    """

    def __init__(self, rounds: int, operations: int, folder: Path) -> None:
        self.rounds = rounds
        self.operations = operations
        self.folder = folder

    def chains(self) -> dict[int, Growth]:
        """Measure chains by their number of tanks, one integration step a sample."""
        found: dict[int, Growth] = {}
        for tanks in CHAINS:
            path = chain_file(tanks, self.folder)
            start = time.perf_counter()
            load_process(path)
            load = time.perf_counter() - start
            point = chain_point(path)
            expected = chain_levels(point)
            found[tanks] = self._growth(point, 1, load, expected, SAME_STEPS)
        return found

    def catalogue(self) -> list[Growth]:
        """Measure every process of the catalogue, with the steps that its own dynamics ask for."""
        found = []
        for name in catalogue_names():
            start = time.perf_counter()
            process = load_process(name)
            load = time.perf_counter() - start
            point = find_equilibrium(process)
            substeps = substeps_for(linearise(point))
            expected = reference_state(point, substeps)
            found.append(self._growth(point, substeps, load, expected, OTHER_STEPS))
        return found

    def _growth(
        self,
        point: OperatingPoint,
        substeps: int,
        load: float,
        expected: np.ndarray,
        bound: float,
    ) -> Growth:
        start = time.perf_counter()
        program = open_loop_program(point, substeps)
        write = time.perf_counter() - start
        operations = sum(1 for _ in program.block.operations())
        samples = max(100, self.operations // (operations * substeps))
        cache = ObjectCache(self.folder / point.process.name)
        kernel = Kernel(program, record=False, cache=cache)
        with on_one_core():
            batch = _batch(kernel, point, samples)
            start = time.perf_counter()
            kernel.function(batch.lanes)
            compiled = time.perf_counter() - start
            one = kernel.prepare(samples, inputs=_inputs(point), state=motion_at_rest(point))
            difference = _compare(kernel, point, expected, bound)
            timings = interleave([Way("one", one.run), Way("batch", batch.run)], self.rounds)
        return Growth(
            point.process.name, operations, substeps, load, write, compiled,
            timings.of("one").times(1 / samples),
            timings.of("batch").times(1 / (samples * batch.scenarios)),
            difference,
        )  # fmt: skip


def _inputs(point: OperatingPoint) -> dict[str, float]:
    at = point.as_dict()
    process = point.process
    return {signal.name: at[signal.name] for signal in (*process.inputs, *process.disturbances)}


def _batch(kernel: Kernel, point: OperatingPoint, samples: int) -> Job:
    """Lay out 64 scenarios, each from contents of its own near the operating point."""
    generator = np.random.Generator(np.random.PCG64(20240229))
    rest = motion_at_rest(point)
    start: dict[str, ArrayLike] = {
        signal.name: rest[signal.name] * generator.uniform(1 - SPREAD, 1 + SPREAD, 64)
        for signal in point.process.motion.contents
    }
    return kernel.prepare(samples, inputs=_inputs(point), state={**rest, **start})


def _moved(point: OperatingPoint) -> np.ndarray:
    """Return the operating point's state with its first entry a twentieth higher."""
    state = point.state.copy()
    state[0] *= 1 + SPREAD
    return state


def chain_levels(point: OperatingPoint) -> np.ndarray:
    """Return the levels of a chain after some samples, from `_moved`, by RK4 in NumPy [m]."""
    area, outlet, gravity, pump = 100e-4, 0.5e-4, 9.81, 5.0 * 10e-6

    def slope(levels: np.ndarray) -> np.ndarray:
        out = outlet * np.sqrt(2 * gravity * levels)
        return (np.concatenate([[pump], out[:-1]]) - out) / area

    levels = _moved(point)
    for _ in range(_COMPARED):
        k1 = slope(levels)
        k2 = slope(levels + k1 / 2)
        k3 = slope(levels + k2 / 2)
        k4 = slope(levels + k3)
        levels = levels + (k1 + 2 * k2 + 2 * k3 + k4) / 6
    return levels


def reference_state(point: OperatingPoint, substeps: int) -> np.ndarray:
    """Return the state after some samples, from `_moved`, by the solver that has no kernel."""
    process = point.process
    name = process.state[0].name
    profiles = {name: np.full(_COMPARED, value) for name, value in _inputs(point).items()}
    found = simulate(
        point, profiles, substeps=substeps, state={name: float(_moved(point)[0])},
        solver="reference",
    )  # fmt: skip
    last = found.to_pandas().iloc[-1]
    return np.array([last[signal.name] for signal in process.state])


def _compare(kernel: Kernel, point: OperatingPoint, expected: np.ndarray, bound: float) -> float:
    """Return how far a kernel ends from an expected state, over the size of the contents.

    Raises
    ------
    Disagreement
        Further than the bound.
    """
    process = point.process
    p = process.parameter_values
    start, final = (
        np.array(process.motion.to_contents(state, p)).ravel()
        for state in (_moved(point), expected)
    )
    names = [signal.name for signal in process.motion.contents]
    rest = motion_at_rest(point) | dict(zip(names, start.tolist(), strict=True))
    found = kernel.run(_COMPARED, inputs=_inputs(point), state=rest)
    here = np.array([found.state(name)[0] for name in names])
    difference = float(np.max(np.abs(here - final) / np.abs(final).max()))
    if not difference <= bound:
        raise Disagreement(
            f"{process.name} differs from the solution it is compared with by {difference:.1e}"
        )
    return difference
