"""A process over one sampling period as a program, without a controller."""

from __future__ import annotations

from typing import Literal

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.loop.alarms import LoopAlarms, append_by_hand
from clepsydra.loop.motion_block import MotionBlock
from clepsydra.loop.reported_readings import append_reported, reporting_state
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
    alarms: LoopAlarms | None = None,
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
    alarms : LoopAlarms, optional
        Those of the process, which look at the start of the period and hold inputs from there.

    Returns
    -------
    Program
        State: that of the motion, what the sensors have not told yet, and that of the alarms.
        Inputs: inputs and disturbances, held over the period. Outputs: states of the process, what
        the sensors tell without noise, what is recorded; with alarms the inputs as they are moved,
        and what the alarms tell.
    """
    reporting, outside = reporting_state(process), (*process.inputs, *process.disturbances)
    state = (*motion.state, *reporting, *(alarms.state if alarms else ()))
    told = (*process.parameters, *motion.parameters)
    names = [s.name for s in (*state, *outside, *told)]
    builder = BlockBuilder(len(names))
    value = {name: index for index, name in enumerate(names)}
    parameters = [value[p.name] for p in process.parameters]
    before = [value[s.name] for s in motion.state]

    # Elsewhere a run may have other steps and the same sensors.
    steps = motion.substeps if shown == "end" else 1

    def looked_at(moment: tuple[int, ...] | list[int]) -> tuple[list[int], list[int]]:
        by_name = dict(zip((s.name for s in motion.state), moment, strict=True))
        contents = [by_name[s.name] for s in process.motion.contents]
        states = inline(builder, process.motion.to_state, [*contents, *parameters], fused=True)
        measured = inline(builder, reading or process.show, [*states, *parameters], fused=True)
        seen = dict(zip((y.name for y in process.measurements), measured, strict=True))
        reported, waiting = append_reported(builder, process, value, seen, steps)
        told = seen | reported
        outputs = [*states, *told.values(), *(by_name[s.name] for s in recorded)]
        if alarms is None:
            return outputs, waiting
        ringing = append_by_hand(alarms, builder, value, told)
        return [*outputs, *(value[s.name] for s in alarmed)], [*waiting, *ringing]

    alarmed = (*process.inputs, *alarms.signals) if alarms else ()
    looked = looked_at(before) if shown == "start" else None
    after = motion.move(builder, before, [value[s.name] for s in (*outside, *told)])
    outputs, waiting = looked or looked_at(after)
    block = builder.finish([*after, *waiting, *outputs])
    return Program(
        f"{process.name}, open loop",
        state,
        outside,
        told,
        (*process.state, *process.measurements, *recorded, *alarmed),
        block,
    )
