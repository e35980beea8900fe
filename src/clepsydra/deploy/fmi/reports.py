"""What sensors tell late or seldom, in a model for co-simulation."""

from __future__ import annotations

from dataclasses import dataclass, replace

from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.model_header import call_beside
from clepsydra.deploy.process_program import HELD, without_fused
from clepsydra.loop.reported_readings import append_reported, reporting_state
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.program import Program
from clepsydra.program.reader import inline


@dataclass(frozen=True)
class Reports:
    """How the sensors of a process go on at the end of an integration step made in parts.

    Parameters
    ----------
    program : Program
        Without state: from what the process holds and what the sensors have told, to what they have
        told then and what is written to their rings.
    function : str
        C of ``model_report``.
    rings : tuple of DelayRing
        Readings on their way.
    """

    program: Program
    function: str
    rings: tuple[DelayRing, ...]


def reports_of_step(process: Process, name: str) -> Reports | None:
    """Return how the sensors of a process go on; None where each tells at once what it reads.

    Parameters
    ----------
    process : Process
        With the integration step as its sampling period.
    name : str
        Of the program of a whole step.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> reports_of_step(load_process("quadruple-tank"), "tank") is None
    True
    """
    state = tuple(map(_held, reporting_state(process)))
    if not state:
        return None
    contents = tuple(map(_named, process.motion.contents))
    inputs = (*contents, *map(signal_of, state))
    builder = BlockBuilder(len(inputs) + len(process.parameters))
    first = len(contents)
    names = (signal_of(entry).name for entry in reporting_state(process))
    value = {each: first + place for place, each in enumerate(names)}
    parameters = range(len(inputs), len(inputs) + len(process.parameters))
    states = inline(builder, process.motion.to_state, [*range(first), *parameters])
    shown = inline(builder, process.show, [*states, *parameters])
    seen = dict(zip((y.name for y in process.measurements), shown, strict=True))
    _, following = append_reported(builder, process, value, seen)
    outputs = tuple(map(signal_of, state))
    program = without_fused(
        Program(
            f"{name}_report", (), inputs, process.parameters, outputs, builder.finish(following)
        )
    )
    members = {each.name: f"state.{each.identifier}" for each in inputs}
    members |= {entry.name: oldest(entry) for entry in state if isinstance(entry, DelayRing)}
    members |= {each.name: f"parameters.{each.identifier}" for each in process.parameters}
    comment = "What the sensors tell at the end of an integration step."
    rings = tuple(entry for entry in state if isinstance(entry, DelayRing))
    return Reports(program, call_beside("model_report", comment, program, members), rings)


def oldest(ring: DelayRing) -> str:
    """Return the member of the memory that holds what comes out of a ring in this step.

    Examples
    --------
    >>> oldest(DelayRing(Signal("pipe.flow"), 1))
    'state.pipe_flow'
    """
    name = ring.signal.identifier
    place = f"state.{name}"
    return f"{place}[memory->{place}_position]" if is_ring(ring) else place


def turned_on(ring: DelayRing) -> list[str]:
    """Return the statements that let a ring go on by one.

    Examples
    --------
    >>> turned_on(DelayRing(Signal("pipe.flow"), 1))
    []
    """
    if not is_ring(ring):
        return []
    position = f"memory->state.{ring.signal.identifier}_position"
    return [f"{position} = {position} + 1 < {ring.length} ? {position} + 1 : 0;"]


def _held(entry: Signal | DelayRing) -> Signal | DelayRing:
    if isinstance(entry, DelayRing):
        return replace(entry, signal=_named(entry.signal))
    return _named(entry)


def _named(signal: Signal) -> Signal:
    return replace(signal, name=f"{HELD}.{signal.name}", kind="real")
