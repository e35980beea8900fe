"""A process as a program that every printer takes: the tank beside the controller."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import MotionBlock, motion_at_rest
from clepsydra.loop.process_period import process_period
from clepsydra.loop.reported_readings import reporting_at
from clepsydra.loop.step_size import substeps_for
from clepsydra.program.defaults import with_defaults
from clepsydra.program.entries import with_signal
from clepsydra.program.operation import Operation
from clepsydra.program.program import Call, Program, Statement

#: What the names of the state begin with: levels are outputs too, and a function block of
#: Structured Text has one set of names.
HELD = "held"


def process_program(point: OperatingPoint, substeps: int | None = None) -> Program:
    """Return one sampling period of a process, with no fused operation.

    The program starts with the process at rest. Its inputs are the inputs and disturbances of
    the process, held over the period, with the point's values as initial ones; its outputs are
    the states and the measurements without noise at the end of the period, so that a controller
    which runs after it reads what the plant would show at its next scan.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts.
    substeps : int, optional
        Integration steps in a sampling period; as many as `substeps_for` says if left out.

    Returns
    -------
    Program
        Named after the process and its variant; each state is named "held." and what it holds.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> program = process_program(find_equilibrium(load_process("quadruple-tank")), 1)
    >>> program.name, program.state[0].name, round(program.outputs[0].initial, 5)
    ('quadruple_tank', 'held.tank_1.level', 0.12263)
    """
    process = point.process
    substeps = substeps_for(linearise(point)) if substeps is None else substeps
    motion = MotionBlock(process.motion, process.sampling_period, substeps)
    moving = process_period(process, motion, (), shown="end")
    at = point.as_dict()
    shown = {y.name: at[y.name] for y in process.measurements}
    started = with_defaults(
        without_fused(moving),
        motion_at_rest(point)
        | reporting_at(process, shown, asked=True, steps=substeps)
        | {signal.name: at[signal.name] for signal in moving.inputs},
    )
    return replace(
        started,
        name=process.file_stem.replace("-", "_"),
        state=tuple(with_signal(entry, _held) for entry in started.state),
        outputs=tuple(replace(s, initial=at[s.name]) for s in started.outputs),
    )


def without_fused(program: Program) -> Program:
    """Return a program in which no multiplication is fused into an addition.

    It computes what CasADi computes, with a rounding after every operation, and every printer
    takes it.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> square = Block(1, (Operation(1, "multiply", (0, 0), fused=True),), (1,))
    >>> program = Program("square", (), (), (), (), square)
    >>> [operation.fused for operation in without_fused(program).block.operations()]
    [False]
    """

    def statement(each: Statement) -> Statement:
        if isinstance(each, Call):
            return replace(each, program=without_fused(each.program))
        return replace(each, fused=False) if isinstance(each, Operation) else each

    return replace(program, block=program.block.with_statements(statement))


def _held(signal: Signal) -> Signal:
    # Counts of events grow without bound, so they are numbers and no integers of the target.
    return replace(signal, name=f"{HELD}.{signal.name}", kind="real")
