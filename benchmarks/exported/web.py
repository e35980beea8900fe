"""Exported WebAssembly: its size, and many scans of it in Wasmtime."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np

from clepsydra.engine.hosted_module import HostedModule
from clepsydra.engine.kernel import Job
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.program import Program


@dataclass(frozen=True)
class ModuleSize:
    """What a module takes, and what it takes deflated, as it goes over a wire [bytes]."""

    whole: int
    deflated: int


class ExportedModule:
    """The module of a controller, laid out to run the scans of a job.

    Parameters
    ----------
    program : Program
    job : Job
        Of a kernel of the same program.
    """

    def __init__(self, program: Program, job: Job) -> None:
        module = web_assembly(program)
        self.size = ModuleSize(len(module), len(zlib.compress(module, 9)))
        self._job, self._hosted = job, HostedModule(module)
        self._start = job.initial[:, : len(program.state)]
        self._shape = job.samples, len(program.outputs)
        self._places = self._hosted.put_job(job)

    def run(self) -> None:
        """Run all scans from the initial state; what delay rings hold goes on."""
        self._hosted.write(self._places[0], self._start)
        self._hosted.call(self._places, samples=self._job.samples, turns=self._job.turns)

    def outputs(self) -> np.ndarray:
        """Return the outputs of the last run [scans, q]."""
        found = self._hosted.read(self._places[4], self._shape[0] * self._shape[1])
        return found.reshape(self._shape)
