"""The motion of a process over one sampling period, as statements and as a program."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice

import casadi as ca
import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.lane_status import STATUS_SIGNALS, append_status, step_check
from clepsydra.loop.motion_step import MotionStep, located_step
from clepsydra.loop.reported_readings import reporting_at
from clepsydra.process.motion import Motion
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.program import Block
from clepsydra.program.reader import inline

#: Number of integration steps since the start of a run, which dates the events.
CLOCK = "clock.steps"
#: Parameters of a program whose integration steps each run is told: how long, and how many.
STEP_LENGTH = Signal("integration.step_length", "s")
STEPS = Signal("integration.steps", kind="integer", low=1.0, initial=1.0)
#: What a ring keeps of a delayed quantity for each integration step.
RING_PARTS = ("start", "mean", "end")


@dataclass(frozen=True)
class PartOfStep:
    """A part of an integration step, as values of the block that moves over it.

    Parameters
    ----------
    first, last : int
        Fractions of the step between which it lies.
    entered : tuple of int
        Of what enters each delay: its integral from the start of the step, over its length.

    Examples
    --------
    >>> PartOfStep(first=0, last=1, entered=()).last
    1
    """

    first: int
    last: int
    entered: tuple[int, ...]


@dataclass(frozen=True)
class MotionBlock:
    """The motion of a process from one sample to the next, in equal integration steps.

    Parameters
    ----------
    motion : Motion
    period : float
        Sampling period [s].
    substeps : int
        Integration steps in it.
    totals : tuple of str
        Those totals that are integrated.
    watched : Process or None
        The process, where each step is to be checked for a status, see
        `clepsydra.loop.lane_status`.
    adjustable : bool
        Whether each run is told as parameters how long a step is and how many there are. Runs that
        stand side by side may have different steps: the loop turns for the one that has most, and
        where a run has made its steps it stands still. Not where there is a delay, whose rings are
        as long as it has steps.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> block = MotionBlock(load_process("quadruple-tank").motion, period=1.0, substeps=2)
    >>> [signal.name for signal in block.state][:2], block.step_length
    (['tank_1.level', 'tank_2.level'], 0.5)
    """

    motion: Motion
    period: float
    substeps: int
    totals: tuple[str, ...] = ()
    watched: Process | None = None
    adjustable: bool = False

    @property
    def step_length(self) -> float:
        """Length of an integration step [s]."""
        return self.period / self.substeps

    @property
    def state(self) -> tuple[Signal, ...]:
        """What lives from sample to sample, apart from the rings of the delays.

        Contents, totals, memories, and for every event "event.count" and "event.time" [s].
        """
        motion = self.motion
        totals = [replace(s, initial=0.0) for s in motion.totals if s.name in self.totals]
        return (
            *motion.contents,
            *totals,
            *motion.memories,
            *(Signal(event.counted, kind="integer", low=0.0) for event in motion.events),
            *(Signal(event.dated, "s") for event in motion.events),
            *((Signal(CLOCK, kind="integer", low=0.0),) if motion.events else ()),
            *(STATUS_SIGNALS if self.watched else ()),
        )

    @property
    def parameters(self) -> tuple[Signal, ...]:
        """What a run is told beside the parameters of the process."""
        return (STEP_LENGTH, STEPS) if self.adjustable else ()

    @property
    def rings(self) -> tuple[DelayRing, ...]:
        """Start, mean and end of every delayed quantity, kept for its time."""
        return tuple(
            DelayRing(
                Signal(ring_name(delay.name, part), delay.unit),
                round(delay.time / self.step_length),
            )
            for delay in self.motion.delays
            for part in RING_PARTS
        )

    def move(
        self, builder: BlockBuilder, state: Sequence[int], outside: Sequence[int]
    ) -> tuple[int, ...]:
        """Append the motion over a sampling period and return the values of the next state.

        Parameters
        ----------
        builder : BlockBuilder
        state : sequence of int
            Values of `state`.
        outside : sequence of int
            Values of inputs, disturbances, parameters and `parameters`, held over the period.
        """
        if self.substeps == 1 and not self.motion.delays and not self.adjustable:
            return tuple(self._step(builder, list(state), [], list(outside))[0])
        turn = MotionBlock._turn if self.watched else _unwatched_turn
        counted = [builder.constant(0.0)] if self.adjustable else []
        carried = builder.loop(
            "integration", turn(self, len(outside)), self.substeps, (), [*state, *counted],
            outside, self.rings, adjustable=self.adjustable,
        )  # fmt: skip
        return carried[: len(state)]

    def _turn(self, outside: int) -> Block:
        """Return the body of the loop of steps, with so many values that are held outside."""
        sizes = len(self.state), int(self.adjustable), len(self.rings), outside
        inner = BlockBuilder(sum(sizes))
        held, counted, ring, rest, _ = _parts(range(sum(sizes)), *sizes)
        following, written = self._step(inner, held, ring, rest)
        if self.adjustable:
            moves = inner.operation("less", *counted, rest[-1])
            pairs = zip(following, held, strict=True)
            following = [inner.operation("select", moves, after, now) for after, now in pairs]
            following.append(inner.operation("add", *counted, inner.constant(1.0)))
        return inner.finish([*following, *written])

    def move_part(
        self,
        builder: BlockBuilder,
        part: PartOfStep,
        state: Sequence[int],
        ring: Sequence[int],
        outside: Sequence[int],
    ) -> tuple[list[int], list[int]]:
        """Append the motion over a part of an integration step, in which nothing is checked.

        Parameters
        ----------
        builder : BlockBuilder
        part : PartOfStep
        state, outside : sequence of int
            See `move`; the clock stays.
        ring : sequence of int
            Start, mean and end of what comes out of every delay during the whole step.

        Returns
        -------
        state, written : list of int
            The next state, and of what enters each delay its value at the start of the part, its
            integral since the start of the step over the length of the step, and its value at the
            end of the part.
        """
        return self._step(builder, list(state), list(ring), list(outside), part)

    def _step(
        self,
        builder: BlockBuilder,
        state: list[int],
        ring: list[int],
        outside: list[int],
        part: PartOfStep | None = None,
    ) -> tuple[list[int], list[int]]:
        """Append one step; return the next state and what is written to the rings."""
        motion = self.motion
        step = MotionStep(motion, self.totals)
        integrated = step.size - len(motion.delays)
        events, memories = len(motion.events), len(motion.memories)
        sizes = integrated, memories, events, events, bool(events)
        integral, m, count, time, clock, status = _parts(state, *sizes)
        invariants = [*ring, *outside]
        h, outside = self._held(builder, outside)
        zero, one = builder.constant(0.0), builder.constant(1.0)
        if part:
            zero, one = part.first, part.last
            invariants += [zero, one]
            integral += [builder.operation("multiply", mean, h) for mean in part.entered]
        else:
            integral += [zero] * len(motion.delays)
        after = inline(
            builder, step.advance, [h, zero, one, *integral, *ring, *m, *outside], fused=True
        )
        following = m
        check = step_check(self.watched, step) if self.watched else None
        whole = [h, zero, one, *integral, *after, *ring, *m, *outside]
        too_long = inline(builder, check, whole, fused=True) if check else []
        if events:
            guards = inline(builder, step.guards, [one, *after, *ring, *m, *outside], fused=True)
            limit = builder.constant(0.0)
            happens = builder.operation("less_equal", limit, guards[0])
            for guard in guards[1:]:
                fires = builder.operation("less_equal", limit, guard)
                happens = builder.operation("or", happens, fires)
            carried = [*after, *count, *time, *m, *too_long]
            invariants = [*clock, *integral, *invariants]
            body = self._located(step, check, len(carried), len(invariants), cut=part is not None)
            changed = builder.conditional("event", happens, body, carried, invariants)
            after, count, time, following, too_long = _parts(changed, *step.located)
            if not part:
                clock = [builder.operation("add", *clock, one)]
        written: list[int] = []
        if motion.delays:
            first = inline(builder, step.sent, [zero, *integral, *ring, *m, *outside], fused=True)
            last = inline(
                builder, step.sent, [one, *after, *ring, *following, *outside], fused=True
            )
            for start, total, end in zip(first, after[integrated:], last, strict=True):
                written += [start, builder.operation("divide", total, h), end]
        if self.watched:
            parameters = outside[len(outside) - step.held[-1].numel() :]
            status = append_status(
                builder, self.watched, step, status, [*after, *parameters], *too_long
            )
        if memories:
            following = inline(
                builder, step.updates, [one, *after, *ring, *following, *outside], fused=True
            )
        return [*after[:integrated], *following, *count, *time, *clock, *status], written

    def _held(self, builder: BlockBuilder, outside: list[int]) -> tuple[int, list[int]]:
        """Return the length of a step, and what else is held."""
        if self.adjustable:
            return outside[-2], outside[:-2]
        return builder.constant(self.step_length), outside

    def _located(
        self,
        step: MotionStep,
        check: ca.Function | None,
        carried: int,
        invariants: int,
        *,
        cut: bool,
    ) -> Block:
        """Return the block that repeats a step in which something happens."""
        inner = BlockBuilder(carried + invariants)
        _, count, time, m, _ = _parts(range(carried), *step.located)
        held = range(carried, carried + invariants)
        (clock,), integral, ring, outside = _parts(held, 1, step.size, step.ring.numel())
        told = [outside.pop(-2), outside.pop()] if cut else []
        h, outside = self._held(inner, outside)
        now = inner.operation("multiply", clock, h)
        arguments = [h, now, *integral, *ring, *count, *time, *m, *outside, *told]
        located = located_step(step, check, cut=cut)
        return inner.finish(inline(inner, located, arguments, fused=True))


@lru_cache(maxsize=4)
def _unwatched_turn(block: MotionBlock, outside: int) -> Block:
    """Return `MotionBlock._turn`, read once for all controllers of a study."""
    return block._turn(outside)


def _parts(values: Iterable[int], *sizes: int) -> list[list[int]]:
    """Return so many values each, one part after the other, and then the rest."""
    rest = iter(values)
    return [*(list(islice(rest, size)) for size in sizes), list(rest)]


def steps_told(period: float, substeps: Sequence[int]) -> dict[str, np.ndarray]:
    """Return the parameters by which runs are told their steps [runs].

    >>> steps_told(1.0, [1, 4])
    {'integration.step_length': array([1.  , 0.25]), 'integration.steps': array([1., 4.])}
    """
    steps = np.array(substeps, float)
    return {STEP_LENGTH.name: period / steps, STEPS.name: steps}


def motion_at_rest(point: OperatingPoint) -> dict[str, float]:
    """Return what lives from sample to sample by name, at rest; nothing has happened yet."""
    process, values = point.process, point.process.parameter_values
    shown = np.array(process.show(point.state, values)).ravel()
    by_name = {y.name: float(v) for y, v in zip(process.measurements, shown, strict=True)}
    return {
        **motion_from(process.motion, point.state, point.inputs, point.disturbances, values),
        **reporting_at(process, by_name),
    }


def motion_from(
    motion: Motion, state: np.ndarray, inputs: np.ndarray, disturbances: np.ndarray, p: np.ndarray
) -> dict[str, float]:
    """Return the same at a state, where what enters the delays then has always entered them."""
    c, z, *_ = motion.at_rest(state, inputs, disturbances, p)
    rings = {
        ring_name(delay.name, part): float(value)
        for delay, value in zip(motion.delays, z, strict=True)
        for part in RING_PARTS
    }
    return {
        **{signal.name: float(value) for signal, value in zip(motion.contents, c, strict=True)},
        **{signal.name: signal.initial for signal in motion.memories},
        **rings,
    }


def recorded_signals(process: Process) -> tuple[Signal, ...]:
    """Return what a run records beside the states: volumes spilt, memories, counts and times."""
    motion = process.motion
    block = MotionBlock(motion, 1.0, 1, tuple(process.spilt.values()))
    return block.state[len(motion.contents) :]


def ring_name(delay: str, part: str) -> str:
    """Return the name of the ring that keeps one part of a delayed quantity.

    >>> ring_name("channel.delayed_flow", "mean")
    'channel.delayed_flow.mean'
    """
    return f"{delay}.{part}"
