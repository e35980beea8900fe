"""A WebAssembly module in a proof: one instance of its state, called scan by scan by Wasmtime."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from clepsydra.deploy.proof.instance import Instance
from clepsydra.engine.hosted_module import HostedModule
from clepsydra.engine.trajectories import follow_rings, rings_and_turns
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.inlined import inlined
from clepsydra.program.program import Program


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
        super().__init__(program)
        self._flat, self._hosted = inlined(program), HostedModule(module)
        self._printed = {parameter.name: parameter.initial for parameter in program.parameters}
        rings = [[ring.signal.initial] * ring.length for ring, _ in rings_and_turns(self._flat)]
        self._ringed = sum(map(len, rings))
        (
            self._state, self._parameters, self._inputs, self._outputs, self._rings
        ) = self._hosted.put([
            np.array([signal_of(entry).initial for entry in program.state]),
            np.array(list(self._printed.values())),
            np.array([signal.initial for signal in program.inputs]),
            np.zeros(len(program.outputs)),
            np.concatenate([[], *rings]),
        ])  # fmt: skip

    def __call__(self, inputs: Mapping[str, float]) -> list[float]:
        """Run one scan and return the outputs in the program's order."""
        program, hosted = self.program, self._hosted
        hosted.write(self._inputs, np.array([inputs[signal.name] for signal in program.inputs]))
        tuned = [self._parameter(inputs, name) for name in self._printed]
        hosted.write(self._parameters, np.array(tuned))
        given = (self._inputs, self._inputs, self._outputs, self._rings)
        hosted.call((self._state, self._parameters, *given))
        held = hosted.read(self._rings, self._ringed)
        follow_rings(self._flat, held[None, :, None], 1)
        hosted.write(self._rings, held)
        return hosted.read(self._outputs, len(program.outputs)).tolist()

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        values = self._hosted.read(self._state, len(self.program.state))
        rings, first = self._hosted.read(self._rings, self._ringed), 0
        for place, entry in enumerate(self.program.state):
            if isinstance(entry, DelayRing):
                values[place] = rings[first]
                first += entry.length
        return values.tolist()

    def _parameter(self, given: Mapping[str, float], name: str) -> float:
        value = given.get(name, math.nan)
        return self._printed[name] if math.isnan(value) else value
