"""A process as a program that every printer takes: the tank beside the controller."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.signal import Signal
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import MotionBlock, motion_at_rest, process_period
from clepsydra.loop.step_size import substeps_for
from clepsydra.program.defaults import with_defaults
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import Entry
from clepsydra.program.program import Program
from clepsydra.program.unfused import without_fused

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
    started = with_defaults(
        without_fused(moving),
        motion_at_rest(point) | {signal.name: at[signal.name] for signal in moving.inputs},
    )
    return replace(
        started,
        name=process.file_stem.replace("-", "_"),
        state=tuple(_held(entry) for entry in started.state),
        outputs=tuple(replace(s, initial=at[s.name]) for s in started.outputs),
    )


def _held(entry: Entry) -> Entry:
    if isinstance(entry, DelayRing):
        return replace(entry, signal=_held_signal(entry.signal))
    return _held_signal(entry)


def _held_signal(signal: Signal) -> Signal:
    # Counts of events grow without bound, so they are numbers and no integers of the target.
    return replace(signal, name=f"{HELD}.{signal.name}", kind="real")
