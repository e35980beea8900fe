"""A WebAssembly module in Wasmtime: its memory, and its kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clepsydra.engine.job import Job
from clepsydra.engine.vector_code import KERNEL
from clepsydra.engine.web_assembly import HEAP

Array = NDArray[np.float64]
_PAGE = 1 << 16


def laid_out(job: Job) -> list[Array]:
    """Return what a run that was laid out for a native kernel puts into the memory of a module.

    State, parameters, shared and individual inputs, room for its record, and rings.
    """
    program = job.kernel.program
    record = np.zeros((job.samples, len(program.outputs)))
    state = job.initial[:, : len(program.state)]
    return [state, job.parameters, job.shared, job.individual, record, job.initial_rings()]


class HostedModule:
    """An instance of a module of `clepsydra.engine.web_assembly`.

    Parameters
    ----------
    module : bytes

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.engine.web_assembly import web_assembly
    >>> from clepsydra.program.program import Block, Operation, Program
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> hosted = HostedModule(web_assembly(program))
    >>> state, u, y = hosted.put([np.array([1.0]), np.array([0.5, 0.25]), np.zeros(2)])
    >>> hosted.call([state, u, u, u, y, u], samples=2)
    >>> hosted.read(y, 2).tolist(), hosted.read(state, 1).tolist()
    ([1.5, 1.75], [1.75])
    """

    def __init__(self, module: bytes) -> None:
        import wasmtime

        self._store = wasmtime.Store()
        limits = wasmtime.MemoryType(wasmtime.Limits(1, None))
        self._memory = wasmtime.Memory(self._store, limits)
        compiled = wasmtime.Module(self._store.engine, module)
        instance = wasmtime.Instance(self._store, compiled, [self._memory])
        exports: Any = instance.exports(self._store)
        self._kernel, self._free = exports[KERNEL], exports[HEAP].value(self._store)

    def put(self, arrays: Sequence[Array]) -> list[int]:
        """Put arrays into the memory, one behind the other, and return their addresses."""
        ends = np.cumsum([self._free, *(array.nbytes for array in arrays)]).tolist()
        missing = -(-ends[-1] // _PAGE) - self._memory.size(self._store)
        if missing > 0:
            self._memory.grow(self._store, missing)
        for place, array in zip(ends, arrays, strict=False):
            self.write(place, array)
        self._free = ends.pop()
        return ends

    def put_job(self, job: Job) -> list[int]:
        """Put a run that was laid out for a native kernel, see `laid_out`."""
        return self.put(laid_out(job))

    def write(self, place: int, array: Array) -> None:
        """Write numbers to an address."""
        self._memory.write(self._store, np.asarray(array, dtype=float).tobytes(), place)

    def read(self, place: int, count: int) -> Array:
        """Return numbers from an address on."""
        content = self._memory.read(self._store, place, place + 8 * count)
        return np.frombuffer(bytes(content), dtype=float).copy()

    def call(
        self, places: Sequence[int], *, samples: int = 1, every: int = 1, turns: int = 1
    ) -> None:
        """Run the kernel.

        Parameters
        ----------
        places : sequence of int
            The addresses of state, parameters, shared and individual inputs, record and rings, as
            `clepsydra.engine.vector_code.vector_code` takes them.
        """
        self._kernel(self._store, *places, 1, samples, every, turns)
