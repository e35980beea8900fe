"""A kernel that is called sample by sample, for what is decided outside of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from clepsydra.base.errors import InputError
from clepsydra.engine.kernel import Kernel
from clepsydra.engine.trajectories import follow_rings, rings_by_name


class Snapshot(NamedTuple):
    """Everything that lives from sample to sample in a run.

    Parameters
    ----------
    state : ndarray [1, n, 1]
    rings : ndarray [1, entries of all rings, 1]
        The oldest entry of each first.
    """

    state: np.ndarray
    rings: np.ndarray


class SteppedKernel:
    """One run of a kernel that stands still between its samples.

    A call computes what the kernel computes in a sample of a whole run, bit for bit; it takes
    some ten microseconds.

    Parameters
    ----------
    kernel : Kernel
        Without individual inputs.
    inputs, parameters, state : mapping, optional
        Numbers by name; an input keeps its value until `look` or `step` gives another one.
    rings : mapping, optional
        Delay ring to what it holds at first, the oldest first [length].

    Raises
    ------
    InputError
        A name is unknown.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.reader import program_of
    >>> from clepsydra.program.step_law import Equations, step_law
    >>> law = step_law("counter", inputs=[Signal("step")], parameters=[], state=[Signal("count")],
    ...                outputs=[Signal("count_now")],
    ...                equations=lambda s: Equations({"count": s["count"] + s["step"]},
    ...                                              {"count_now": s["count"]}))
    >>> counter = SteppedKernel(Kernel(program_of(law)))
    >>> counter.step({"step": 2.0}), counter.look({}), counter.step({"step": 1.0})
    ({'count_now': 0.0}, {'count_now': 2.0}, {'count_now': 2.0})
    >>> before = counter.snapshot()
    >>> first = counter.step({"step": 5.0}), counter.step({})
    >>> counter.restore(before)
    >>> first == (counter.step({"step": 5.0}), counter.step({}))
    True
    """

    def __init__(
        self,
        kernel: Kernel,
        *,
        inputs: Mapping[str, ArrayLike] | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        state: Mapping[str, ArrayLike] | None = None,
        rings: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        job = kernel.prepare(1, inputs=inputs, parameters=parameters, state=state, rings=rings)
        self._program = program = kernel.program
        self._names = [signal.name for signal in program.outputs]
        self._columns = {signal.name: place for place, signal in enumerate(program.inputs)}
        self._state = job.initial[:, : len(program.state)].copy()
        self._rings = job.initial_rings()
        self._job, self._call = job, kernel.function(1).call

    def look(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Return the outputs of the next sample under these inputs, and stay where it is."""
        return self._run(self._state.copy(), self._rings.copy(), inputs)

    def step(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Go through the next sample and return its outputs."""
        outputs = self._run(self._state, self._rings, inputs)
        follow_rings(self._program, self._rings, 1)
        return outputs

    def snapshot(self) -> Snapshot:
        """Return where the run stands, to go on from there later, here or in a copy."""
        return Snapshot(self._state.copy(), self._rings.copy())

    def restore(self, snapshot: Snapshot) -> None:
        """Stand where a run of the same kernel stood; inputs keep their last values.

        Raises
        ------
        InputError
            The snapshot is of another kernel.
        """
        held = Snapshot(self._state, self._rings)
        for own, other in zip(held, snapshot, strict=True):
            if own.shape != other.shape:
                raise InputError(
                    f"run of {self._program.name}, snapshot", f"{other.size} numbers",
                    f"{own.size}, as a run of the same kernel has", "take it of such a run",
                )  # fmt: skip
        self._state[:], self._rings[:] = snapshot

    @property
    def state(self) -> dict[str, float]:
        """The state that the next sample begins with; what is in rings stands in `rings`."""
        names = (entry.name for entry in self._program.state)
        return dict(zip(names, self._state.ravel().tolist(), strict=True))

    @property
    def rings(self) -> dict[str, np.ndarray]:
        """What each delay ring holds before the next sample, the oldest first [length]."""
        held = rings_by_name(self._program, self._rings)
        return {name: ring.ravel() for name, ring in held.items()}

    def _run(
        self, state: np.ndarray, rings: np.ndarray, inputs: Mapping[str, float]
    ) -> dict[str, float]:
        job = self._job
        for name, value in inputs.items():
            job.shared[0, self._columns[name]] = value
        record = np.empty((1, 1, len(self._names), 1))
        addresses = (a.ctypes.data for a in (job.shared, job.individual, record, rings))
        self._call(state.ctypes.data, job.parameters.ctypes.data, *addresses, 1, 1, 1, job.turns)
        return dict(zip(self._names, record.ravel().tolist(), strict=True))
