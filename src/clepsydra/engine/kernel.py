"""A kernel: a program as machine code, run for many samples and scenarios."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clepsydra.base.errors import InputError
from clepsydra.engine.batch_noise import BatchNoise, LaidNoise
from clepsydra.engine.choice_first import choosing_first
from clepsydra.engine.compiler import FULL, LITTLE, CompiledFunction
from clepsydra.engine.host import host
from clepsydra.engine.job import Job
from clepsydra.engine.kernel_code import kernel_code
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.layout import Layout
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.threads import available_threads
from clepsydra.engine.trajectories import Trajectories
from clepsydra.engine.vector_code import KERNEL, kernel_signature
from clepsydra.engine.vector_parts import has_arrays, stands_in_parts
from clepsydra.program.inlined import inlined
from clepsydra.program.program import Block, Conditional, ForLoop, Program
from clepsydra.program.routine import RoutineCall

Array = NDArray[np.float64]

#: Operations of a program of which a second vector always pays, and of one of which it pays in a
#: batch of so many scenarios that compiling does not count.
_SMALL, _MIDDLE, _MANY = 200, 600, 1024
#: Statements, at most, of the first call of the machine code in a run.
_BEGUN_WITH = 10_000_000


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
        Of every run; if omitted one for one run that is stored, and otherwise what suits the host
        and the size of the program: a kernel that stores nothing is one for batches.
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
        #: Of which it is made anew, for another machine too.
        self._given: dict[str, Any] = {
            "program": program, "individual": tuple(individual), "fuse": fuse, "record": record,
            "lanes": lanes, "cache": cache,
        }  # fmt: skip
        self.program = program = choosing_first(inlined(program))
        self.records = record
        self._individual = frozenset(individual)
        self._fuse = fuse and host().fuses
        self._lanes = lanes
        self._one_alone = record and lanes is None
        self._cache = cache
        self.layout = Layout(program, self._individual)
        self._compiled: dict[tuple[int, frozenset[str]], CompiledFunction] = {}
        self._turns = _turns(program)
        self._paces: dict[int, int] = {}
        self._check("lanes", 1 if lanes is None else lanes, "leave it out")

    def __reduce__(self) -> tuple[partial[Kernel], tuple[()]]:
        """Return how it is made of what it was made of; the machine that gets it compiles it."""
        return partial(Kernel, **self._given), ()

    def prepare(
        self,
        samples: int,
        *,
        inputs: Mapping[str, ArrayLike] | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        state: Mapping[str, ArrayLike] | None = None,
        rings: Mapping[str, ArrayLike] | None = None,
        noise: BatchNoise | None = None,
        every: int = 1,
        turns: int | None = None,
    ) -> Job:
        """Lay out a run in memory.

        Parameters
        ----------
        samples : int
        inputs : mapping
            Shared inputs as a number or [samples], individual inputs as [scenarios, samples];
            an input that is left out keeps its initial value.
        parameters, state : mapping
            A number for all, or [scenarios]; what is left out keeps its initial value. The
            number of a delay ring, of the state or of a loop, is its whole initial content.
        rings : mapping
            Delay ring to what it holds at first, the oldest first, in the place of its number:
            [length] in every scenario, or [scenarios, length].
        noise : BatchNoise, optional
            Is added to inputs, shared or individual.
        every : int
            Outputs are stored in samples 0, every, 2·every, …
        turns : int, optional
            Of the adjustable loops of the program, if not those that they have.

        Raises
        ------
        InputError
            An unknown name, a shape that does not fit, a number of the noise outside of its range,
            no sample or no turn at all.
        """
        turns = self._turns if turns is None else turns
        self._check("turns", turns, "leave it out")
        self._check("samples", samples, "ask for a longer run")
        self._check("every", every, "store every sample, or every second, third, …")
        inputs, parameters, state, rings = inputs or {}, parameters or {}, state or {}, rings or {}
        layout = self.layout
        scenarios = layout.scenarios(inputs, rings, noise, parameters, state)
        noisy = [name for name in layout.noisy(noise) if name in self._read] if noise else []
        lanes = 1 if scenarios == 1 and self._one_alone else self._batch_lanes(scenarios)
        return Job(
            kernel=self,
            samples=samples,
            scenarios=scenarios,
            lanes=lanes,
            every=every,
            turns=turns,
            initial=layout.state(state, scenarios, lanes),
            held=layout.rings(rings, scenarios, lanes),
            parameters=layout.parameters(parameters, scenarios, lanes),
            shared=layout.shared(inputs, samples),
            individual=layout.individual(inputs, samples, scenarios, lanes),
            noise=LaidNoise(noise, noisy, scenarios, lanes, self._cache)
            if noise and noisy
            else None,
        )

    def run(
        self,
        samples: int,
        *,
        inputs: Mapping[str, ArrayLike] | None = None,
        parameters: Mapping[str, ArrayLike] | None = None,
        state: Mapping[str, ArrayLike] | None = None,
        rings: Mapping[str, ArrayLike] | None = None,
        noise: BatchNoise | None = None,
        every: int = 1,
        turns: int | None = None,
        threads: int | None = None,
    ) -> Trajectories:
        """Run all scenarios from their initial state; arguments as in `prepare`.

        Parameters
        ----------
        threads : int, optional
            All processors that this process may use, if omitted.
        """
        threads = available_threads() if threads is None else threads
        self._check("threads", threads, "leave it out")
        job = self.prepare(
            samples,
            inputs=inputs,
            parameters=parameters,
            state=state,
            rings=rings,
            noise=noise,
            every=every,
            turns=turns,
        )
        return job.run(threads)

    def _check(self, name: str, value: int, remedy: str) -> None:
        if value < 1:
            place = f"run of {self.program.name}, {name}"
            raise InputError(place, value, "a whole number of at least 1", remedy)

    def function(self, lanes: int, noisy: frozenset[str] = frozenset()) -> CompiledFunction:
        """Return the machine code for lanes and noisy inputs, compiled when first asked for."""
        if (lanes, noisy) not in self._compiled:
            form = KernelForm(lanes, self._individual, self._fuse, self.records, host(), noisy)
            code = kernel_code(self.program, form)
            in_a_row = stands_in_parts(self.program) and not has_arrays(self.program.block)
            self._compiled[lanes, noisy] = CompiledFunction(
                code, KERNEL, kernel_signature(form), self._cache, LITTLE if in_a_row else FULL
            )
        return self._compiled[lanes, noisy]

    def _batch_lanes(self, scenarios: int) -> int:
        """Return two vectors for a small program or a large batch, else one.

        A second vector hides the latency of the first, until a large program runs out of
        registers; and it takes longer to compile. What stands in a conditional is seldom computed
        and does not count.
        """
        if self._lanes is not None:
            return self._lanes
        largest = _SMALL if scenarios < _MANY else _MIDDLE
        return host().lanes * (2 if self.operations < largest else 1)

    @cached_property
    def _read(self) -> frozenset[str]:
        """The inputs that anything of what is kept hangs on."""
        program = self.program
        block, states = program.block, len(program.state)
        if not self.records:
            block = replace(block, results=block.results[:states])
        uses = block.without_unread().uses()
        return frozenset(s.name for at, s in enumerate(program.inputs, start=states) if at in uses)

    @cached_property
    def operations(self) -> int:
        """Operations that are computed in every sample."""
        return _always_computed(self.program.block)

    def pace(self, turns: int) -> int:
        """Return the samples of the first call in a run with so many turns."""
        if turns not in self._paces:
            computed = _computed(self.program.block, turns)
            self._paces[turns] = max(_BEGUN_WITH // max(computed, 1), 1)
        return self._paces[turns]


def _turns(program: Program) -> int:
    """Return the turns of the adjustable loops; one where there is no such loop."""
    loops = (statement for statement in program.block.statements if isinstance(statement, ForLoop))
    return next((loop.count for loop in loops if loop.adjustable), 1)


def _computed(block: Block, turns: int) -> int:
    """Return the statements of a sample at most, with so many turns of adjustable loops."""
    found = 0
    for statement in block.statements:
        if isinstance(statement, ForLoop):
            count = turns if statement.adjustable else statement.count
            found += count * _computed(statement.body, turns)
        elif isinstance(statement, Conditional):
            found += _computed(statement.body, turns)
        elif isinstance(statement, RoutineCall):
            found += statement.routine.extent()
        else:
            found += 1
    return found


def _always_computed(block: Block) -> int:
    found = 0
    for statement in block.statements:
        if isinstance(statement, ForLoop):
            found += _always_computed(statement.body)
        elif isinstance(statement, RoutineCall):
            found += sum(1 for _ in statement.routine.operations())
        elif not isinstance(statement, Conditional):
            found += 1
    return found
