"""The hand-written C++ program: built here, called through ctypes."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import numpy as np

from benchmarks.case import FINAL, RECORDED, Case, Solution

SOURCE = Path(__file__).with_name("quadruple_tank.cpp")
COMPILER = "g++"
OPTIONS = (
    "-std=c++17",
    "-O3",
    "-march=native",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-trapping-math",
    # Packing the four tanks of one run into a vector costs more shuffles than it saves roots.
    "-fno-tree-slp-vectorize",
    "-shared",
    "-fPIC",
)
#: Vectors side by side that are tried; the fastest on this machine is the yardstick.
VECTOR_COUNTS = (1, 2, 3, 4)


class Kind(IntEnum):
    """What a program computes: the bare problem, all guards, or some roots by multiply-adds."""

    BARE = 0
    GUARDED = 1
    FOUR_REFINED = 4
    SIX_REFINED = 6
    EIGHT_REFINED = 8


REFINED = Kind.FOUR_REFINED, Kind.SIX_REFINED, Kind.EIGHT_REFINED


class CompilerMissing(Exception):
    """There is no C++ compiler on this machine, so there is no yardstick."""


def compiler_version() -> str:
    """Return the first line that the compiler says of itself."""
    if shutil.which(COMPILER) is None:
        raise CompilerMissing(f"{COMPILER} is not installed; the benchmarks need it")
    answer = subprocess.run([COMPILER, "--version"], capture_output=True, text=True, check=True)
    return answer.stdout.splitlines()[0]


def _pointer(values: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)


@dataclass(frozen=True)
class CPlusPlus:
    """The built program.

    Parameters
    ----------
    library : ctypes.CDLL
    build_seconds : float
    """

    library: ctypes.CDLL
    build_seconds: float

    @classmethod
    def build(cls, folder: Path, *, every_kind: bool = True) -> CPlusPlus:
        """Compile the program, of every kind or the bare one alone, into `folder` and load it."""
        compiler_version()
        target = folder / "quadruple_tank.so"
        start = time.perf_counter()
        options = OPTIONS if every_kind else (*OPTIONS, "-DONLY_BARE")
        subprocess.run([COMPILER, *options, str(SOURCE), "-o", str(target)], check=True)
        seconds = time.perf_counter() - start
        library = ctypes.CDLL(str(target))
        size, pointer = ctypes.c_size_t, ctypes.c_void_p
        library.lanes.argtypes = [ctypes.c_int]
        library.batch.argtypes = [
            ctypes.c_int, ctypes.c_int, *[pointer] * 4, *[size] * 4, pointer
        ]  # fmt: skip
        library.single.argtypes = [ctypes.c_int, *[pointer] * 3, size, pointer, pointer]
        library.single.restype = None
        library.roots_alone.argtypes = [size, pointer]
        library.roots_alone.restype = None
        return cls(library, seconds)

    def lanes(self, vectors: int) -> int:
        """Return the scenarios that go side by side in so many vectors."""
        return int(self.library.lanes(vectors))

    def batch(
        self, case: Case, vectors: int, threads: int = 1, *, kind: Kind = Kind.BARE
    ) -> Solution:
        """Solve all scenarios, so many vectors of them side by side."""
        lanes = self.lanes(vectors)
        padded = -(-case.scenarios // lanes) * lanes
        parameters, individual = case.parameters, case.individual
        if padded != case.scenarios:
            beyond = ((0, 0), (0, padded - case.scenarios))
            parameters = np.pad(parameters, beyond, mode="edge")
            individual = None if individual is None else np.pad(individual, beyond, mode="edge")
        own = None if individual is None else _pointer(individual)
        final = np.empty((len(FINAL), padded))
        bounds = [part * (padded // lanes) // threads * lanes for part in range(threads + 1)]

        def part(number: int) -> None:
            if self.library.batch(
                kind, vectors, _pointer(parameters), _pointer(case.setpoints),
                _pointer(case.initial_levels), own, padded, case.samples,
                bounds[number], bounds[number + 1], _pointer(final),
            ):  # fmt: skip
                raise ValueError(f"no batch of kind {kind} with {vectors} vectors side by side")

        if threads == 1:
            part(0)
        else:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(part, range(threads)))
        return Solution(final[:, : case.scenarios])

    def roots_alone(self, steps: int) -> np.ndarray:
        """Take as many roots as so many scenario-steps need; return the last of each chain."""
        values = np.linspace(0.01, 0.2, 8 * self.lanes(1))
        self.library.roots_alone(steps, _pointer(values))
        return values

    def single(
        self, case: Case, recorded: np.ndarray, final: np.ndarray, *, kind: Kind = Kind.BARE
    ) -> Solution:
        """Solve one scenario into the arrays given, [samples, 6] and [8, 1]."""
        self.library.single(
            kind, _pointer(case.parameters), _pointer(case.setpoints),
            _pointer(case.initial_levels), case.samples, _pointer(recorded), _pointer(final),
        )  # fmt: skip
        return Solution(final, recorded)


def recording_arrays(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Return arrays for `CPlusPlus.single`, already touched so that no page is missing."""
    return np.zeros((case.samples, len(RECORDED))), np.zeros((len(FINAL), 1))
