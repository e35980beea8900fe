"""A process as a model for co-simulation: it integrates itself in steps of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from clepsydra.base.signal import Signal, path
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable, output_dependencies, variables_of
from clepsydra.deploy.fmi.model_header import call_beside, call_step
from clepsydra.deploy.fmi.part_of_step import parts_of_step
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.process_program import HELD, process_program
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.reported_readings import TOLD
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.program import Program
from clepsydra.program.reader import inline


def process_model(point: OperatingPoint, substeps: int, origin: Origin) -> FmuModel:
    """Return the model of a process that integrates itself, as the simulation does.

    A communication step may have any length: it is made of whole integration steps, and of a part
    of one where it begins or ends between two of them. Inputs and disturbances are held over it.
    The outputs are the states and the measurements without noise at its end.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts.
    substeps : int
        Integration steps in a sampling period.
    origin : Origin

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> model = process_model(point, 2, Origin("the process", "quadruple-tank", "", 1.0))
    >>> model.step, [variable.name for variable in model.outputs][3:5]
    (0.5, ['tank_4.level', 'level_1'])
    """
    process = point.process
    step = process.sampling_period / substeps
    stepping = replace(process, sampling_period=step)
    program = process_program(replace(point, process=stepping), substeps=1)
    parts = parts_of_step(stepping, program.name)
    reading = _reading(process, program)
    members = {s.name: f"parameters.{s.identifier}" for s in program.parameters}
    members |= {s.name: f"state.{s.identifier}" for s in map(signal_of, program.state)}
    members |= {s.name: f"outputs.{s.identifier}" for s in program.outputs}
    show = call_beside("model_show", "The outputs of the present state.", reading, members)
    advance = call_step("model_advance", "One integration step.", program)
    return FmuModel(
        programs=(program, reading, *parts.programs),
        variables=tuple(_variables(process, program, reading)),
        functions="\n".join([show, advance, parts.functions]),
        step=step,
        scans=False,
        title=process.title,
        origin=origin,
        kept=parts.kept,
    )


def _variables(process: Process, program: Program, reading: Program) -> list[FmuVariable]:
    """Return the variables; a state that lives on as it is, such as a level, is an output."""
    held = [signal_of(entry) for entry in program.state if not is_ring(entry)]
    plain = [replace(s, name=s.name.removeprefix(f"{HELD}.")) for s in held]
    names = dict(zip([s.name for s in held], held_signals(process, plain), strict=True))
    shown, contents = shown_contents(process), {s.name for s in process.motion.contents}
    states = [
        FmuVariable(
            names[signal.name],
            f"state.{signal.identifier}",
            "output" if name.name in shown else "local",
            "continuous" if name.name in contents else "discrete",
        )
        for signal, name in zip(held, plain, strict=True)
    ]
    depends_on = [
        tuple(names[name].name if name in names else name for name in each)
        for each in output_dependencies(reading)
    ]
    results = variables_of(program.outputs, "outputs", "output", "continuous", depends_on)
    return [
        *variables_of(program.parameters, "parameters", "parameter", "tunable"),
        *variables_of(program.inputs, "inputs", "input", "continuous"),
        *states,
        *(result for result in results if result.name not in shown),
    ]


def _reading(process: Process, program: Program) -> Program:
    """Return the program of states and measurements as functions of contents and what is told."""
    contents = [
        replace(signal, name=f"{HELD}.{signal.name}", kind="real")
        for signal in process.motion.contents
    ]
    told = {name: Signal(f"{HELD}.{path(name, TOLD)}") for name in process.reporting}
    inputs = (*contents, *told.values())
    builder = BlockBuilder(len(inputs) + len(process.parameters))
    parameters = range(len(inputs), len(inputs) + len(process.parameters))
    states = inline(builder, process.motion.to_state, [*range(len(contents)), *parameters])
    shown = inline(builder, process.show, [*states, *parameters])
    seen = dict(zip((y.name for y in process.measurements), shown, strict=True))
    seen |= {name: len(contents) + place for place, name in enumerate(told)}
    return Program(
        f"{program.name}_reading",
        (),
        inputs,
        process.parameters,
        (*process.state, *process.measurements),
        builder.finish([*states, *seen.values()]),
    )


def shown_contents(process: Process) -> frozenset[str]:
    """Return the names of those contents that are states as they are, such as levels.

    A concentration is no content: the amount is, and the state is computed from it.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> sorted(shown_contents(load_process("averaging-tank")))
    ['tank.level']
    """
    motion = process.motion
    contents = ca.SX.sym("c", len(motion.contents))
    states = motion.to_state(contents, ca.SX.sym("p", len(process.parameters)))
    places = {signal.name: place for place, signal in enumerate(motion.contents)}
    return frozenset(
        signal.name
        for number, signal in enumerate(process.state)
        if signal.name in places and ca.is_equal(states[number], contents[places[signal.name]])
    )


def held_signals(process: Process, signals: Sequence[Signal]) -> list[Signal]:
    """Return the signals of what a process holds, under names that nothing else has.

    Each keeps its name; where another variable has it, "held." stands before it.

    Parameters
    ----------
    process : Process
    signals : sequence of Signal
        Contents, memories and whatever else lives from step to step.
    """
    shown = shown_contents(process)
    others = (process.parameters, process.inputs, process.disturbances, process.measurements)
    taken = {signal.name for group in others for signal in group}
    taken |= {signal.name for signal in process.state} - shown
    # Counts of events grow without bound, so they are numbers and no integers of the target.
    return [
        replace(s, name=f"{HELD}.{s.name}" if s.name in taken else s.name, kind="real")
        for s in signals
    ]
