"""A run of a kernel, laid out in memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.engine.batch_noise import Further, LaidNoise
from clepsydra.engine.compiler import CompiledFunction
from clepsydra.engine.layout import Layout
from clepsydra.engine.pacing import Pacing
from clepsydra.engine.threads import in_threads
from clepsydra.engine.trajectories import Trajectories, follow_rings
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program

Array = NDArray[np.float64]


def _nothing_further(start: int, first: int) -> tuple[Sequence[int], Sequence[int]]:
    """Return what a kernel without noise is given beside what every kernel is."""
    return (), ()


class Runs(Protocol):
    """What a job is a run of: a kernel."""

    program: Program
    records: bool
    layout: Layout

    def function(self, lanes: int, noisy: frozenset[str] = ...) -> CompiledFunction:
        """Return the machine code for a number of lanes."""
        ...

    def pace(self, turns: int) -> int:
        """Return the samples of the first call in a run."""
        ...


@dataclass(frozen=True, eq=False)
class Job:
    """A run laid out in memory, ready to be started once or often.

    Parameters
    ----------
    kernel : Kernel
    samples, scenarios, lanes, every, turns : int
    initial : ndarray [groups, n + r, lanes]
        The state, then the rings of loops.
    held : dict
        Delay ring to what it holds at first [groups or 1, length, lanes or 1], where that is not
        its number.
    parameters : ndarray [groups, p, lanes]
    shared : ndarray [samples, s]
    individual : ndarray [groups, samples, i, lanes]
    noise : LaidNoise or None
    rings : ndarray [groups, entries of all rings, lanes] or None
        What all delay rings hold at first, where it is not told by their numbers and `held`.
    anew : mapping
        Place of a state to what it is at first in all scenarios, in the place of `initial`.
    """

    kernel: Runs
    samples: int
    scenarios: int
    lanes: int
    every: int
    turns: int
    initial: Array
    held: dict[str, Array]
    parameters: Array
    shared: Array
    individual: Array
    noise: LaidNoise | None = None
    rings: Array | None = None
    anew: Mapping[int, float] = field(default_factory=dict)

    def run(self, threads: int = 1) -> Trajectories:
        """Run every scenario on some threads and return what was computed."""
        program = self.kernel.program
        groups = len(self.initial)
        state = self.initial[:, : len(program.state)].copy()
        for place, value in self.anew.items():
            state[:, place] = value
        records = -(-self.samples // self.every) if self.kernel.records else 0
        record = np.empty((groups, records, len(program.outputs), self.lanes))
        rings = self.initial_rings()
        noise = self.noise
        function = self.kernel.function(self.lanes, noise.names if noise else frozenset())
        pace = self.kernel.pace(self.turns)
        if groups * self.samples <= pace:
            threads = 1  # to begin another takes longer than the first call

        def call(start: int, stop: int, first: int, last: int, further: Further) -> None:
            made, begun = further(start, first)
            function.call(
                state[start:].ctypes.data,
                self.parameters[start:].ctypes.data,
                self.shared[first:].ctypes.data,
                self.individual[start, first:].ctypes.data,
                record[start, first // self.every :].ctypes.data,
                rings[start:].ctypes.data,
                *made,
                stop - start,
                last - first,
                self.every,
                self.turns,
                *begun,
            )
            follow_rings(program, rings[start:stop], last - first)

        def work(start: int, stop: int) -> Iterator[None]:
            pacing, first = Pacing(pace), 0
            further = noise.for_a_thread() if noise else _nothing_further
            while start < stop:
                many = pacing.pace // self.samples if first == 0 else 0
                after, last = min(start + max(many, 1), stop), self.samples
                if not many:  # a part of a run
                    last = min(first + max(pacing.pace // self.every, 1) * self.every, last)
                with pacing:
                    call(start, after, first, last, further)
                start, first = (after, 0) if last == self.samples else (start, last)
                yield

        in_threads(work, groups, threads)
        return Trajectories(program, self.scenarios, state, record, rings)

    def following(
        self,
        result: Trajectories,
        samples: int,
        inputs: Mapping[str, ArrayLike],
        state: Mapping[str, float],
    ) -> Job:
        """Return the run that goes on where this one ended, with the same parameters.

        Parameters
        ----------
        result : Trajectories
            What this run computed.
        samples : int
        inputs : mapping
            As for `Kernel.prepare`, from the first sample of the run that follows.
        state : mapping
            States that begin anew, in all scenarios with the same value.

        Examples
        --------
        >>> from clepsydra.base.signal import Signal
        >>> from clepsydra.engine.kernel import Kernel
        >>> from clepsydra.program.reader import program_of
        >>> from clepsydra.program.step_law import Equations, step_law
        >>> law = step_law("counter", inputs=[Signal("step")], parameters=[],
        ...                state=[Signal("count")], outputs=[],
        ...                equations=lambda s: Equations({"count": s["count"] + s["step"]}, {}))
        >>> job = Kernel(program_of(law), record=False).prepare(4, inputs={"step": 2.0})
        >>> job.following(job.run(), 2, {"step": 5.0}, {}).run().state("count")
        array([18.])
        """
        layout = self.kernel.layout
        places = {entry.name: place for place, entry in enumerate(self.kernel.program.state)}
        return replace(
            self,
            samples=samples,
            initial=result.by_lanes,
            anew={places[name]: value for name, value in state.items()},
            rings=result.held,
            shared=layout.shared(inputs, samples),
            individual=layout.individual(inputs, samples, self.scenarios, self.lanes),
            noise=self.noise and self.noise.after(self.samples),
        )

    def initial_rings(self) -> Array:
        """Return what the delay rings hold at first [groups, entries of all rings, lanes]."""
        if self.rings is not None:
            return self.rings.copy()
        program, groups = self.kernel.program, len(self.initial)
        filled = [
            np.broadcast_to(self.held[entry.name], (groups, entry.length, self.lanes))
            if entry.name in self.held
            else np.repeat(self.initial[:, index : index + 1, :], entry.length, axis=1)
            for index, entry in enumerate((*program.state, *program.rings))
            if isinstance(entry, DelayRing)
        ]
        if not filled:
            return np.empty((groups, 0, self.lanes))
        return np.ascontiguousarray(np.concatenate(filled, axis=1))
