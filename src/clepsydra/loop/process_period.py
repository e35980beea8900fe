"""A process over one sampling period as a program, without a controller."""

from __future__ import annotations

from typing import Literal

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.loop.motion_block import MotionBlock
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program
from clepsydra.program.reader import inline


def process_period(
    process: Process,
    motion: MotionBlock,
    recorded: tuple[Signal, ...],
    *,
    shown: Literal["start", "end"],
    reading: ca.Function | None = None,
) -> Program:
    """Return the program that carries a process over one sampling period.

    Parameters
    ----------
    process : Process
    motion : MotionBlock
        Its motion, with period, integration steps and totals.
    recorded : tuple of Signal
        What else of `motion.state` is an output.
    shown : {"start", "end"}
        The end of the period at which the outputs are taken.
    reading : casadi.Function, optional
        (x, p) → measurements, `Process.show` where left out.

    Returns
    -------
    Program
        State: that of the motion. Inputs: inputs and disturbances, held over the period.
        Outputs: states of the process, what the sensors show without noise, what is recorded.
    """
    state, outside = motion.state, (*process.inputs, *process.disturbances)
    told = (*process.parameters, *motion.parameters)
    names = [s.name for s in (*state, *outside, *told)]
    builder = BlockBuilder(len(names))
    value = {name: index for index, name in enumerate(names)}
    parameters = [value[p.name] for p in process.parameters]
    before = [value[s.name] for s in state]

    def outputs(moment: tuple[int, ...] | list[int]) -> list[int]:
        by_name = dict(zip((s.name for s in state), moment, strict=True))
        contents = [by_name[s.name] for s in process.motion.contents]
        states = inline(builder, process.motion.to_state, [*contents, *parameters], fused=True)
        measured = inline(builder, reading or process.show, [*states, *parameters], fused=True)
        return [*states, *measured, *(by_name[s.name] for s in recorded)]

    results = outputs(before) if shown == "start" else []
    after = motion.move(builder, before, [value[s.name] for s in (*outside, *told)])
    block = builder.finish([*after, *(results or outputs(after))])
    return Program(
        f"{process.name}, open loop",
        state,
        outside,
        told,
        (*process.state, *process.measurements, *recorded),
        block,
    )
