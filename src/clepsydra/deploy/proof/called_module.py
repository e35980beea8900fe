"""A WebAssembly module in a proof: one instance of its state, called scan by scan by Wasmtime."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from clepsydra.deploy.proof.instance import Array, Instance
from clepsydra.engine.trajectories import follow_rings, rings_and_turns
from clepsydra.engine.vector_code import KERNEL
from clepsydra.engine.web_assembly import HEAP
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.inlined import inlined
from clepsydra.program.program import Program

_PAGE = 1 << 16


class CalledModule(Instance):
    """An instance of a module of `clepsydra.engine.web_assembly`.

    Parameters
    ----------
    program : Program
        What it was made of.
    module : bytes

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.engine.web_assembly import web_assembly
    >>> from clepsydra.program.program import Block, Operation
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> CalledModule(program, web_assembly(program)).run({"u": np.array([0.5, 0.25])}).tolist()
    [[0.5, 0.5], [0.75, 0.75]]
    """

    def __init__(self, program: Program, module: bytes) -> None:
        import wasmtime

        super().__init__(program)
        self._flat = inlined(program)
        self._store = wasmtime.Store()
        self._memory = wasmtime.Memory(self._store, wasmtime.MemoryType(wasmtime.Limits(1, None)))
        compiled = wasmtime.Module(self._store.engine, module)
        instance = wasmtime.Instance(self._store, compiled, [self._memory])
        exports: Any = instance.exports(self._store)
        self._kernel, heap = exports[KERNEL], exports[HEAP].value(self._store)
        rings = [[ring.signal.initial] * ring.length for ring, _ in rings_and_turns(self._flat)]
        groups: dict[str, list[float]] = {
            "state": [signal_of(entry).initial for entry in program.state],
            "parameters": [signal.initial for signal in program.parameters],
            "inputs": [signal.initial for signal in program.inputs],
            "outputs": [0.0] * len(program.outputs),
            "rings": [value for ring in rings for value in ring],
        }
        self._places: dict[str, tuple[int, int]] = {}
        for name, values in groups.items():
            self._places[name] = heap, heap + 8 * len(values)
            heap += 8 * len(values)
        missing = -(-heap // _PAGE) - self._memory.size(self._store)
        if missing > 0:
            self._memory.grow(self._store, missing)
        for name, values in groups.items():
            self._write(name, np.array(values, dtype=float))
        self._printed = {parameter.name: parameter.initial for parameter in program.parameters}

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in the program's order."""
        program = self.program
        if program.inputs:
            self._write("inputs", np.array([inputs[each.name] for each in program.inputs]))
        if program.parameters:
            self._write("parameters", np.array([self._parameter(inputs, p) for p in self._printed]))
        start = [place for place, _ in self._places.values()]
        state, parameters, given, outputs, rings = start
        self._kernel(self._store, state, parameters, given, given, outputs, rings, 1, 1, 1, 1)
        held = self._read("rings")
        follow_rings(self._flat, held[None, :, None], 1)
        self._write("rings", held)
        return self._read("outputs").tolist()

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        values, rings, first = self._read("state"), self._read("rings"), 0
        for place, entry in enumerate(self.program.state):
            if isinstance(entry, DelayRing):
                values[place] = rings[first]
                first += entry.length
        return values.tolist()

    def _parameter(self, given: Mapping[str, float], name: str) -> float:
        value = given.get(name, math.nan)
        return self._printed[name] if math.isnan(value) else value

    def _write(self, group: str, values: Array) -> None:
        self._memory.write(self._store, values.astype(float).tobytes(), self._places[group][0])

    def _read(self, group: str) -> Array:
        content = self._memory.read(self._store, *self._places[group])
        return np.frombuffer(bytes(content), dtype=float).copy()
