"""A part of an integration step, where a communication step ends between two of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.model_header import call_beside, function_text
from clepsydra.deploy.fmi.reports import Reports, oldest, reports_of_step, turned_on
from clepsydra.deploy.process_program import HELD, without_fused
from clepsydra.loop.motion_block import CLOCK, MotionBlock, PartOfStep
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program

#: Fractions of the integration step between which the part lies.
_FIRST, _LAST = Signal("integration.first"), Signal("integration.last")


@dataclass(frozen=True)
class Parts:
    """How a process moves over parts of an integration step.

    Parameters
    ----------
    programs : tuple of Program
        Without state: from what the process holds, what comes out of its delays, what has
        entered them since the start of the step and what is held from outside, to what it holds
        at the end of the part and what has entered its delays by then; and of late sensors that of
        `reports_of_step`.
    functions : str
        C of ``model_part`` and ``model_complete``.
    kept : tuple of str
        The numbers that the memory of the model has for it.
    """

    programs: tuple[Program, ...]
    functions: str
    kept: tuple[str, ...]


def parts_of_step(process: Process, name: str) -> Parts:
    """Return how a process moves over parts of an integration step.

    Each part is one Runge-Kutta step in which events are located. Of what enters a delay the
    parts keep what a whole step keeps, its value at both ends and its integral, so that a delay
    loses no liquid where a communication step ends, whatever happens there.

    Parameters
    ----------
    process : Process
        With the integration step as its sampling period.
    name : str
        Of the program of a whole step.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> parts = parts_of_step(load_process("quadruple-tank"), "tank")
    >>> parts.programs[0].name, parts.kept
    ('tank_part', ('integration_first', 'integration_last'))
    """
    motion = MotionBlock(process.motion, process.sampling_period, 1)
    held = tuple(replace(s, name=f"{HELD}.{s.name}", kind="real") for s in motion.state)
    leaving = tuple(ring.signal for ring in motion.rings)
    entered = tuple(replace(s, name=f"entered.{s.name}") for s in leaving)
    outside = (*process.inputs, *process.disturbances)
    inputs = (*held, *leaving, *entered, _FIRST, _LAST, *outside)
    builder = BlockBuilder(len(inputs) + len(process.parameters))
    value = {s.name: place for place, s in enumerate((*inputs, *process.parameters))}

    def values(signals: tuple[Signal, ...]) -> list[int]:
        return [value[signal.name] for signal in signals]

    starts, means = values(entered[::3]), values(entered[1::3])
    part = PartOfStep(value[_FIRST.name], value[_LAST.name], tuple(means))
    after, written = motion.move_part(
        builder, part, values(held), values(leaving), values((*outside, *process.parameters))
    )
    begins = builder.operation("less_equal", part.first, builder.constant(0.0))
    for place, start in enumerate(starts):
        written[3 * place] = builder.operation("select", begins, written[3 * place], start)
    program = without_fused(
        Program(
            f"{name}_part",
            (),
            inputs,
            process.parameters,
            (*held, *entered),
            builder.finish([*after, *written]),
        )
    )
    kept = tuple(signal.identifier for signal in (*entered, _FIRST, _LAST))
    members = {s.name: f"state.{s.identifier}" for s in held}
    members |= {ring.name: oldest(ring) for ring in motion.rings}
    members |= {s.name: s.identifier for s in (*entered, _FIRST, _LAST)}
    members |= {s.name: f"inputs.{s.identifier}" for s in outside}
    members |= {s.name: f"parameters.{s.identifier}" for s in process.parameters}
    reports = reports_of_step(process, name)
    functions = [_part(program, members), _complete(motion, entered, reports)]
    if reports is None:
        return Parts((program,), "\n".join(functions), kept)
    return Parts((program, reports.program), "\n".join([reports.function, *functions]), kept)


def _part(program: Program, members: dict[str, str]) -> str:
    told = [f"memory->{s.identifier} = {s.name.rpartition('.')[2]};" for s in (_FIRST, _LAST)]
    comment = "The motion between two fractions of an integration step."
    return call_beside(
        "model_part", comment, program, members, given="double first, double last", before=told
    )


def _complete(motion: MotionBlock, entered: tuple[Signal, ...], reports: Reports | None) -> str:
    """Write that a step which was made in parts is over."""
    body = []
    for ring, signal in zip(motion.rings, entered, strict=True):
        body.append(f"memory->{oldest(ring)} = memory->{signal.identifier};")
        body.append(f"memory->{signal.identifier} = 0.0;")
        body += turned_on(ring)
    if motion.motion.events:
        body.append(f"memory->state.{Signal(f'{HELD}.{CLOCK}').identifier} += 1.0;")
    if reports is not None:
        body.append("model_report(memory);")
        for ring in reports.rings:
            body += turned_on(ring)
    comment = "What enters the delays in the step goes on its way."
    return function_text("model_complete", body or ["(void)memory;"], comment)
