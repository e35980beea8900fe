"""A kernel: a program as machine code, run for many samples and scenarios."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError
from clepsydra.engine.compiler import CompiledFunction, kernel_signature
from clepsydra.engine.host import host
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.threads import in_threads
from clepsydra.engine.vector_code import KERNEL, KernelForm, vector_code
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Program

Array = NDArray[np.float64]

_LARGE_PROGRAM = 200


@dataclass(frozen=True)
class Trajectories:
    """What a kernel computed.

    Parameters
    ----------
    program : Program
    scenarios : int
    final_state : ndarray [n, scenarios]
        In the order of the program's state; entries of delay rings are not used.
    record : ndarray [groups, records, q, lanes]
        As the kernel laid it down; `output` gives it by name.
    """

    program: Program
    scenarios: int
    final_state: Array
    record: Array

    def output(self, name: str) -> Array:
        """Return the trajectory of an output [scenarios, records], a view where possible."""
        names = [signal.name for signal in self.program.outputs]
        column = self.record[:, :, names.index(name), :]
        return column.transpose(0, 2, 1).reshape(-1, column.shape[1])[: self.scenarios]

    def record_of(self, scenario: int) -> Array:
        """Return every output of one scenario [records, q]."""
        group, lane = divmod(scenario, self.record.shape[-1])
        return self.record[group, :, :, lane]

    def state(self, name: str) -> Array:
        """Return the final value of a state [scenarios]."""
        names = [entry.name for entry in self.program.state]
        return self.final_state[names.index(name)]


class Kernel:
    """A program compiled for this machine, one lane for one run, many lanes for a batch.

    Parameters
    ----------
    program : Program
    individual : collection of str
        Inputs that differ from scenario to scenario; all others are shared.
    fuse : bool
        Whether operations that allow it become fused multiply-adds.
    record : bool
        Whether outputs are stored.
    lanes : int, optional
        Lanes of a batch; chosen from the host and the size of the program if omitted.
    cache : ObjectCache, optional
        Where compiled objects are kept; the user's cache folder if omitted.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.reader import program_of
    >>> from clepsydra.program.step_law import Equations, step_law
    >>> law = step_law("counter", inputs=[Signal("step")], parameters=[], state=[Signal("count")],
    ...                outputs=[Signal("count_now")],
    ...                equations=lambda s: Equations({"count": s["count"] + s["step"]},
    ...                                              {"count_now": s["count"]}))
    >>> Kernel(program_of(law)).run(4, inputs={"step": 2.0}).output("count_now")
    array([[0., 2., 4., 6.]])
    """

    def __init__(
        self,
        program: Program,
        *,
        individual: Collection[str] = (),
        fuse: bool = True,
        record: bool = True,
        lanes: int | None = None,
        cache: ObjectCache | None = None,
    ) -> None:
        self.program = program
        self._individual = frozenset(individual)
        self._fuse = fuse and host().fuses
        self.records = record
        self._batch_lanes = _batch_lanes(program) if lanes is None else lanes
        self._cache = cache
        self._shared_names = [s.name for s in program.inputs if s.name not in self._individual]
        self._individual_names = [s.name for s in program.inputs if s.name in self._individual]
        self._initial_inputs = {s.name: s.initial for s in program.inputs}
        self._initial_parameters = {s.name: s.initial for s in program.parameters}
        self._initial_state = {
            x.name: (x.signal if isinstance(x, DelayRing) else x).initial for x in program.state
        }

    def prepare(
        self,
        samples: int,
        *,
        inputs: Mapping[str, ArrayLike] | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        state: Mapping[str, ArrayLike] | None = None,
        every: int = 1,
    ) -> Job:
        """Lay out a run in memory.

        Parameters
        ----------
        samples : int
        inputs : mapping
            Shared inputs as a number or [samples], individual inputs as [scenarios, samples];
            an input that is left out keeps its initial value.
        parameters, state : mapping
            A number for all, or [scenarios]; what is left out keeps its initial value.
        every : int
            Outputs are stored in samples 0, every, 2·every, …

        Raises
        ------
        InputError
            An unknown name, a shape that does not fit, or no sample at all.
        """
        program = self.program
        if samples < 1 or every < 1:
            raise InputError(
                f"run of {program.name}", min(samples, every), "at least 1 sample",
                "ask for a longer run or a smaller stride",
            )  # fmt: skip
        given_inputs, given_parameters = dict(inputs or {}), dict(parameters or {})
        given_state = dict(state or {})
        scenarios = self._scenarios(given_inputs, given_parameters, given_state)
        lanes = 1 if scenarios == 1 else self._batch_lanes
        groups = -(-scenarios // lanes)
        return Job(
            kernel=self,
            samples=samples,
            scenarios=scenarios,
            lanes=lanes,
            every=every,
            initial=self._columns(
                "state", self._initial_state, given_state, scenarios, groups, lanes
            ),
            parameters=self._columns(
                "parameter", self._initial_parameters, given_parameters, scenarios, groups, lanes
            ),
            shared=self._shared_inputs(given_inputs, samples),
            individual=self._individual_inputs(given_inputs, samples, scenarios, groups, lanes),
        )

    def run(
        self,
        samples: int,
        *,
        inputs: Mapping[str, ArrayLike] | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        state: Mapping[str, ArrayLike] | None = None,
        every: int = 1,
        threads: int = 1,
    ) -> Trajectories:
        """Run all scenarios from their initial state; arguments as in `prepare`."""
        job = self.prepare(samples, inputs=inputs, parameters=parameters, state=state, every=every)
        return job.run(threads)

    def function(self, lanes: int) -> CompiledFunction:
        """Return the machine code for a number of lanes, compiled when first asked for."""
        return self._one_run if lanes == 1 else self._batch

    @cached_property
    def _one_run(self) -> CompiledFunction:
        return self._compiled(1)

    @cached_property
    def _batch(self) -> CompiledFunction:
        return self._compiled(self._batch_lanes)

    def _compiled(self, lanes: int) -> CompiledFunction:
        form = KernelForm(lanes, self._individual, self._fuse, self.records)
        code = vector_code(self.program, form)
        return CompiledFunction(code, KERNEL, kernel_signature(), self._cache)

    def _scenarios(self, *groups: dict[str, ArrayLike]) -> int:
        inputs, *columns = groups
        sizes: dict[int, str] = {}
        for group in columns:
            for name, value in group.items():
                if not isinstance(value, (int, float)) and np.ndim(value) == 1:
                    sizes[len(np.asarray(value))] = name
        for name in self._individual_names:
            if name in inputs:
                sizes[len(np.asarray(inputs[name]))] = name
        if len(sizes) > 1:
            names = " and ".join(sizes.values())
            raise InputError(
                f"run of {self.program.name}",
                sorted(sizes),
                "one number of scenarios",
                f"give {names} the same number of entries",
            )
        return next(iter(sizes), 1)

    def _columns(
        self,
        kind: str,
        initial: dict[str, float],
        given: dict[str, ArrayLike],
        scenarios: int,
        groups: int,
        lanes: int,
    ) -> Array:
        self._refuse_unknown(kind, given, initial)
        numbers = {**initial, **given}
        if groups * lanes == 1 and all(isinstance(v, (int, float)) for v in numbers.values()):
            return np.array([list(numbers.values())], dtype=float).reshape(1, -1, 1)
        table = np.empty((len(numbers), groups * lanes))
        for row, (name, number) in zip(table, numbers.items(), strict=True):
            value = np.asarray(number, dtype=float)
            if value.ndim > 1:
                raise self._shape_error(name, value, "a number or [scenarios]")
            row[:scenarios] = value
            row[scenarios:] = row[scenarios - 1]
        shaped = table.reshape(len(numbers), groups, lanes)
        return np.ascontiguousarray(shaped.transpose(1, 0, 2))

    def _shared_inputs(self, given: dict[str, ArrayLike], samples: int) -> Array:
        self._refuse_unknown("input", given, self._initial_inputs)
        table = np.empty((samples, len(self._shared_names)))
        for index, name in enumerate(self._shared_names):
            value = np.asarray(given.get(name, self._initial_inputs[name]), dtype=float)
            if value.shape not in ((), (samples,)):
                raise self._shape_error(name, value, f"a number or [{samples}]")
            table[:, index] = value
        return table

    def _individual_inputs(
        self, given: dict[str, ArrayLike], samples: int, scenarios: int, groups: int, lanes: int
    ) -> Array:
        names = self._individual_names
        table = np.empty((groups, samples, len(names), lanes))
        for index, name in enumerate(names):
            value = np.asarray(given.get(name, np.nan), dtype=float)
            if value.shape != (scenarios, samples):
                raise self._shape_error(name, value, f"[{scenarios}, {samples}]")
            rows = np.empty((groups * lanes, samples))
            rows[:scenarios] = value
            rows[scenarios:] = value[-1]
            table[:, :, index, :] = rows.reshape(groups, lanes, samples).transpose(0, 2, 1)
        return table

    def _refuse_unknown(
        self, kind: str, given: Mapping[str, object], known: Mapping[str, float]
    ) -> None:
        for name in given:
            if name not in known:
                raise InputError(
                    f"run of {self.program.name}", name, f"one of its {kind}s",
                    f"the {kind}s are {', '.join(known) or 'none'}",
                )  # fmt: skip

    def _shape_error(self, name: str, value: Array, expected: str) -> InputError:
        return InputError(
            f"run of {self.program.name}, {name}", list(value.shape), f"the shape of {expected}",
            "give one value, or one value for each",
        )  # fmt: skip


def _batch_lanes(program: Program) -> int:
    """Return two vectors for a small program, one for a large one, which fills the units alone.

    A second vector hides the latency of the first, but a large program then runs out of
    registers. The limit lies between one tank (95 operations) and four (281).
    """
    operations = sum(1 for _ in program.block.operations())
    return host().lanes * (2 if operations < _LARGE_PROGRAM else 1)


@dataclass(frozen=True)
class Job:
    """A run laid out in memory, ready to be started once or often.

    Parameters
    ----------
    kernel : Kernel
    samples, scenarios, lanes, every : int
    initial : ndarray [groups, n, lanes]
    parameters : ndarray [groups, p, lanes]
    shared : ndarray [samples, s]
    individual : ndarray [groups, samples, i, lanes]
    """

    kernel: Kernel
    samples: int
    scenarios: int
    lanes: int
    every: int
    initial: Array
    parameters: Array
    shared: Array
    individual: Array

    def run(self, threads: int = 1) -> Trajectories:
        """Run every scenario on some threads and return what was computed."""
        program = self.kernel.program
        groups = len(self.initial)
        state = self.initial.copy()
        records = -(-self.samples // self.every) if self.kernel.records else 0
        record = np.empty((groups, records, len(program.outputs), self.lanes))
        rings = self._initial_rings(groups)
        call = self.kernel.function(self.lanes).call

        def part(start: int, stop: int) -> None:
            call(
                state[start:].ctypes.data,
                self.parameters[start:].ctypes.data,
                self.shared.ctypes.data,
                self.individual[start:].ctypes.data,
                record[start:].ctypes.data,
                rings[start:].ctypes.data,
                stop - start,
                self.samples,
                self.every,
            )

        in_threads(part, groups, threads, cost=self.samples)
        final = state.transpose(1, 0, 2).reshape(len(program.state), -1)[:, : self.scenarios]
        return Trajectories(program, self.scenarios, final, record)

    def _initial_rings(self, groups: int) -> Array:
        entries = self.kernel.program.state
        filled = [
            np.repeat(self.initial[:, index : index + 1, :], entry.length, axis=1)
            for index, entry in enumerate(entries)
            if isinstance(entry, DelayRing)
        ]
        return np.concatenate(filled, axis=1) if filled else np.empty((groups, 0, self.lanes))
