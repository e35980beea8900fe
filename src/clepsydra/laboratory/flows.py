"""Every flow of a plant as it runs, as a program that a page asks once a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si, unit_text
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program
from clepsydra.program.reader import inline
from clepsydra.report.live.modules import Modules

_UNIT = "m^3/s"


def flows_program(process: Process) -> Program:
    """Return a program without a state: signals of a process to every flow of it [m³/s].

    Inputs are state, what leaves the delays, memories, inputs and disturbances; the outputs are
    those of `Motion.flow_paths`, in their order.

    Examples
    --------
    >>> import clepsydra as cl
    >>> program = flows_program(cl.load("quadruple-tank").process)
    >>> len(program.inputs), [signal.name for signal in program.outputs][:2]
    (8, ['flow_1', 'flow_2'])
    """
    motion = process.motion
    delayed = tuple(Signal(each.name, each.unit) for each in motion.delays)
    inputs = (
        *process.state, *delayed, *motion.memories, *process.inputs, *process.disturbances,
    )  # fmt: skip
    builder = BlockBuilder(len(inputs) + len(process.parameters))
    state, outside = range(len(process.state)), range(len(process.state), len(inputs))
    parameters = range(len(inputs), len(inputs) + len(process.parameters))
    contents = inline(builder, motion.to_contents, [*state, *parameters])
    rates = inline(builder, motion.flows, [*contents, *outside, *parameters])
    told = tuple(Signal(f"flow_{place}", _UNIT) for place, _ in enumerate(motion.flow_paths, 1))
    block = builder.finish(rates)
    return Program(f"flows of {process.name}", (), inputs, process.parameters, told, block)


def flows_data(point: OperatingPoint, unit: str, modules: Modules) -> dict[str, Any] | None:
    """Return what a page needs to tell the flows of a plant; None where nothing flows.

    Parameters
    ----------
    point : OperatingPoint
        Where it rests: the greatest flow there is what a drawing calls much.
    unit : str
        In which flows are told.
    """
    process = point.process
    if not process.motion.flow_paths:
        return None
    motion, parameters = process.motion, process.parameter_values
    held = motion.at_rest(point.state, point.inputs, point.disturbances, parameters)
    largest = float(np.max(np.abs(np.array(motion.flows(*held)))))
    program = flows_program(process)
    return {
        "module": modules.add(program),
        "inputs": [signal.name for signal in program.inputs],
        "delays": [each.name for each in motion.delays],
        "parameters": [p.name for p in program.parameters],
        "paths": [each._asdict() for each in motion.flow_paths],
        "much": largest,
        "unit": unit_text(unit),
        "factor": from_si(1.0, _UNIT, unit),
    }
