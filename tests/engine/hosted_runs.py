"""Kernels as WebAssembly in Wasmtime, beside the native kernel with nothing fused."""

import numpy as np

from clepsydra import Kernel
from clepsydra.engine.hosted_module import HostedModule
from clepsydra.engine.web_assembly import web_assembly
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program


def as_bits(numbers: np.ndarray) -> np.ndarray:
    """Return the bits; WebAssembly leaves those of what is not a number open."""
    return np.where(np.isnan(numbers), -1, np.ascontiguousarray(numbers).view(np.int64))


def run_in_module(module: bytes, job) -> tuple[np.ndarray, np.ndarray]:
    """Return what a module records [samples, q], and its last state [n].

    The run was laid out for a native kernel.
    """
    program, hosted = job.kernel.program, HostedModule(module)
    places, outputs = hosted.put_job(job), len(program.outputs)
    hosted.call(places, samples=job.samples, turns=job.turns)
    record = hosted.read(places[4], job.samples * outputs).reshape(job.samples, outputs)
    return record, hosted.read(places[0], len(program.state))


def assert_same(program: Program, samples: int, **given) -> None:
    """Assert that the program's module computes the same in every bit; see `Kernel.prepare`."""
    job = Kernel(program, fuse=False).prepare(samples, **given)
    expected, (record, state) = job.run(), run_in_module(web_assembly(program), job)
    assert record.size or state.size
    np.testing.assert_array_equal(as_bits(record), as_bits(expected.record_of(0)))
    kept = [not isinstance(entry, DelayRing) for entry in job.kernel.program.state]
    np.testing.assert_array_equal(as_bits(state)[kept], as_bits(expected.final_state[:, 0])[kept])
