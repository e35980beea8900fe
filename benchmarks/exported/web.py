"""Exported WebAssembly: its size, and many samples of it in Wasmtime and in Node."""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.exported.families import FAMILIES, at_work
from benchmarks.exported.node import InNode
from benchmarks.exported.times import CALLS, SCANS, agree
from benchmarks.measure import Spread, Way, interleave, on_one_core
from clepsydra.engine.hosted_module import HostedModule, laid_out
from clepsydra.engine.kernel import Job, Kernel
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.operation import LIBRARY

_ENGINE, _WASMTIME, _NODE = "engine, nothing fused", "Wasmtime", "Node"


@dataclass(frozen=True)
class ModuleSize:
    """What a module takes, and what it takes deflated, as it goes over a wire [bytes]."""

    whole: int
    deflated: int


@dataclass(frozen=True)
class WebTimes:
    """What was found for the WebAssembly of one controller, or of its closed loop.

    Parameters
    ----------
    name, process : str
    functions : bool
        Whether a sample has exp, log or another function of the mathematical library.
    module : ModuleSize
    wasmtime, node : Spread
        Processor time over that of the engine's one run with nothing fused, each pair from the
        same round.
    """

    name: str
    process: str
    functions: bool
    module: ModuleSize
    wasmtime: Spread
    node: Spread


class ExportedModule:
    """The module of a program, laid out to run the samples of a job.

    Parameters
    ----------
    job : Job
        Of a kernel of the program.
    """

    def __init__(self, job: Job) -> None:
        self._module = web_assembly(job.kernel.program)
        self.size = ModuleSize(len(self._module), len(zlib.compress(self._module, 9)))
        self._job, self._hosted = job, HostedModule(self._module)
        self._groups = laid_out(job)
        self._places = self._hosted.put(self._groups)

    def run(self) -> None:
        """Run all samples in Wasmtime from the initial state; what delay rings hold goes on."""
        self._hosted.write(self._places[0], self._groups[0])
        self._hosted.call(self._places, samples=self._job.samples, turns=self._job.turns)

    def outputs(self) -> np.ndarray:
        """Return the outputs of the last run in Wasmtime [samples, q]."""
        record = self._groups[4]
        return self._hosted.read(self._places[4], record.size).reshape(record.shape)

    def in_node(self) -> InNode:
        """Return the same in Node."""
        return InNode(self._module, self._groups, self._job.samples, self._job.turns)


def measure_controllers(rounds: int, tell: Callable[[str], None]) -> list[WebTimes]:
    """Measure each controller of `FAMILIES` at work, as it is exported."""
    found = []
    for name, process in FAMILIES.items():
        tell(f"WebAssembly, {name}")
        work = at_work(name, SCANS)
        kernel = Kernel(work.ready.program, fuse=False)
        job = kernel.prepare(SCANS, inputs=work.inputs)
        found.append(measure_one(name, process, job, rounds, CALLS))
    return found


def measure_one(name: str, process: str, job: Job, rounds: int, calls: int = 1) -> WebTimes:
    """Check the module of a program and time it.

    Parameters
    ----------
    name, process : str
    job : Job
        Of a kernel with nothing fused.
    rounds, calls : int
        Of each round's calls the median counts.

    Raises
    ------
    Disagreement
        Engine and WebAssembly differ in a bit.
    """
    program, what = job.kernel.program, f"{name} on {process}"
    with on_one_core():
        web = ExportedModule(job)
        with web.in_node() as node:
            web.run()
            agree(what, job, 0, web.outputs(), _WASMTIME)
            agree(what, job, 0, node.outputs(), _NODE)
            timings = interleave(
                [
                    Way(_ENGINE, job.run, calls),
                    Way(_WASMTIME, web.run, calls),
                    Way(_NODE, node.run, calls),
                ],
                rounds,
                timed=_own_seconds,
            )
    return WebTimes(
        name,
        process,
        any(operation.code in LIBRARY for operation in program.block.operations()),
        web.size,
        timings.ratio(_WASMTIME, _ENGINE),
        timings.ratio(_NODE, _ENGINE),
    )


def _own_seconds(run: Callable[[], object]) -> float:
    """Return the seconds of processor that a run takes here, or says of itself from elsewhere."""
    start = time.thread_time()
    said = run()
    return said if isinstance(said, float) else time.thread_time() - start
