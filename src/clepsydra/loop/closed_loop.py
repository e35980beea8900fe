"""One sample of a closed loop as a program: measure, control, move the process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from clepsydra.base.conversion import Conversion, conversion
from clepsydra.base.signal import Signal, path
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.wiring import controller_name
from clepsydra.loop.alarms import LoopAlarms
from clepsydra.loop.faults import (
    append_final_elements,
    append_readings,
    applied_signals,
    fault_inputs,
    held_states,
)
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.motion_block import MotionBlock
from clepsydra.loop.plant_readings import append_plant_readings, plant_readings
from clepsydra.loop.reported_readings import append_reported, reporting_state
from clepsydra.loop.rims import append_rims, open_rims
from clepsydra.process.alarm import interlocks
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.inlined import append_in_place
from clepsydra.program.operation import TO_SINGLE
from clepsydra.program.program import Program
from clepsydra.program.reader import inline

if TYPE_CHECKING:
    from clepsydra.loop.running_scores import RunningScores


#: Of a measurement: what its sensor would read without noise, resolution and limits.
TRUE = "true"


def wire_conversions(controller: Controller, process: Process) -> dict[str, Conversion]:
    """Return the signals of a law that have another unit than what they are wired to.

    Returns
    -------
    dict
        Input of the law to how it comes from the unit of the process, output to how it gets there.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.controllers.plant_shell.edge import in_shown_units
    >>> plant = cl.load("wet-well")
    >>> controller = in_shown_units(cl.design.simc(plant))
    >>> wire_conversions(controller, plant.process)["duty.out"]
    Conversion(code='divide', number=100.0)
    """
    law, given, told = controller.law, controller.input_wires, controller.output_wires
    units = {s.name: s.unit for s in (*process.measurements, *process.inputs)}
    found: dict[str, Conversion | None] = {}
    for signal in law.inputs:
        found[signal.name] = conversion(_unit(signal, given, units), signal.unit)
    for signal in law.outputs:
        found[signal.name] = conversion(signal.unit, _unit(signal, told, units))
    return {name: way for name, way in found.items() if way is not None}


def _unit(signal: Signal, wires: Mapping[str, str], units: Mapping[str, str]) -> str:
    """Return the unit of what a signal is wired to; its own where that is not of the process."""
    if signal.kind != "real":
        return signal.unit
    wire = wires.get(signal.name, "")
    return units.get(wire) or units.get(Signal(wire).owner, signal.unit)


def closed_loop(
    process: Process,
    controller: Controller,
    *,
    substeps: int,
    constant: Mapping[str, float] | None = None,
    scores: RunningScores | None = None,
    statuses: bool = False,
    adjustable: bool = False,
    readings: bool = False,
    faults: bool = False,
    alarms: bool = False,
    operated: bool = False,
    rims: bool = False,
    law: Program | None = None,
) -> Program:
    """Join a process and a controller to the program of one sampling period.

    At the start of a sample the sensors are read, the step law computes the manipulated
    variables from what they tell by then (`clepsydra.loop.reported_readings`), and these are held
    while RK4 carries the process to the next sample. An input that the law does not move stands
    at its manual value. The process may be computed with fused multiply-adds, the controller
    never.

    Parameters
    ----------
    process : Process
    controller : Controller
    substeps : int
        RK4 steps in one sampling period.
    constant : mapping
        Inputs that never change in the runs to come, by name; they are folded into the
        program and are no inputs any more. Folding changes no bit of any result.
    scores : RunningScores, optional
        Scores of this process to keep as states, for batches that store no trajectories.
    statuses : bool
        Check each integration step and keep a status of the scenario, see
        `clepsydra.loop.lane_status`.
    adjustable : bool
        Let each run say how many steps it takes, see `clepsydra.loop.motion_block`.
    readings : bool
        Record what the sensors would read without noise, resolution and limits too, and
        `clepsydra.loop.plant_readings`.
    faults : bool
        Let sensors and final elements fail, see `clepsydra.loop.faults`.
    alarms : bool
        Record the alarms of the process, see `clepsydra.loop.alarms`. Where some of them hold
        an input they are in the program in any case.
    operated : bool
        Let an operator acknowledge each of the alarms that are recorded, by inputs such as
        "level_1.high.acknowledge".
    rims : bool
        Let open tanks without a weir spill between samples what is above their rim, and record what
        they have spilt, see `clepsydra.loop.rims`.
    law : Program, optional
        The program of the controller in single precision, `in_single_arithmetic`, to stand in the
        place of its law; it gets its inputs in single precision.

    Returns
    -------
    Program
        State: the process's, that of late sensors (`reporting_state`), with faults "u.held", with
        alarms "alarms." + theirs, then "controller." + the law's. Inputs, for a controlled
        measurement y, any measurement m and a manipulated variable u: "y.setpoint", the
        disturbances, "m.noise", "m.sensor" (1 = good), "u.mode", "u.manual", "u.tracking", with
        faults those of `fault_inputs`.
        Parameters: the process's, then "controller." + the law's. Outputs: the process's state,
        the measurements, the manipulated variables, "u.status", and of a cascade
        "m.inner_setpoint", the setpoint of the inner loop of measurement m in this sample; with
        readings "m.true" and those of the plant at the end, with faults "u.applied" behind them.

    Examples
    --------
    >>> from clepsydra.designs.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> analysis = analyse(process)
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> program = closed_loop(process, controller, substeps=2, constant={"pump_1.mode": 1.0})
    >>> len(program.inputs), [signal.name for signal in program.inputs][:2]
    (17, ['level_1.setpoint', 'level_2.setpoint'])
    """
    motion = MotionBlock(
        process.motion,
        process.sampling_period,
        substeps,
        tuple(process.spilt.values()),
        process if statuses else None,
        adjustable,
    )
    constant, own = constant or {}, controller.law
    told, summed = (scores.inputs, scores.state) if scores else ((), ())
    failing, held = (fault_inputs(process), held_states(process)) if faults else ((), ())
    watched = alarms or bool(interlocks(process.alarms))
    alarmed = LoopAlarms(process, operated=operated) if watched and process.alarms else None
    of_alarms, answers = (alarmed.state, alarmed.inputs) if alarmed else ((), ())
    every = (*loop_inputs(process), *free_inputs(controller), *failing, *answers, *told)
    inputs = tuple(signal for signal in every if signal.name not in constant)
    spilling = tuple(open_rims(process).values()) if rims else ()
    living = (*motion.state, *spilling, *reporting_state(process))
    state = (*living, *held, *of_alarms, *map(_renamed, own.state), *summed)
    tuned = (replace(p, name=controller_name(p.name)) for p in own.parameters)
    parameters = (*process.parameters, *tuned, *motion.parameters)
    names = [entry.name for entry in (*state, *inputs, *parameters)]
    builder = BlockBuilder(len(names))
    value = {name: index for index, name in enumerate(names)}
    value |= {name: builder.constant(number) for name, number in constant.items()}
    time_step = builder.constant(process.sampling_period)
    of_process = [value[p.name] for p in process.parameters]
    moving = [value[x.name] for x in motion.state]
    true = _measure(builder, process, value, moving[: len(process.motion.contents)])
    reported, next_reporting = append_reported(builder, process, value, value)
    value |= reported
    if faults:
        value |= append_readings(builder, process, value)
    next_alarms = alarmed.append(builder, value) if alarmed else []
    for u in process.inputs:
        value[u.name] = value[f"{u.name}.manual"]  # where the law does not move it
    next_law = _control(builder, process, controller, value, time_step, law)
    place = {entry.name: index for index, entry in enumerate(own.state)}
    inner = inner_setpoints(controller, process)
    value |= {each.name: next_law[place[each.state]] for each in inner}
    next_alarms += alarmed.moved(value) if alarmed else []
    applied, next_held = append_final_elements(builder, process, value) if faults else ({}, [])
    moved_by = value | applied
    outside = [moved_by[s.name] for s in (*process.inputs, *process.disturbances)]
    lengths = [value[p.name] for p in motion.parameters]
    next_state = motion.move(builder, moving, [*outside, *of_process, *lengths])
    if rims:
        next_state = _spilt(builder, process, value, next_state)
    recorded = (
        *process.state,
        *process.measurements,
        *process.inputs,
        *(Signal(f"{u}.status", kind="integer") for u in controller.manipulated),
        *(each.signal for each in inner),
        *motion.state[len(process.motion.contents) :],
        *spilling,
    )
    added = scores.append(builder, value | true) if scores else []
    shown = [value[signal.name] for signal in recorded]
    if readings:
        named = (replace(y, name=true_name(y)) for y in process.measurements)
        recorded = (*recorded, *named, *plant_readings(process))
        shown += [*true.values(), *append_plant_readings(builder, process, moved_by)]
    if faults:
        recorded = (*recorded, *applied_signals(process))
        shown += applied.values()
    if alarms and alarmed:
        recorded = (*recorded, *alarmed.signals)
        shown += [value[signal.name] for signal in alarmed.signals]
    moved = (*next_state, *next_reporting, *next_held, *next_alarms)
    block = builder.finish([*moved, *next_law, *added, *shown])
    name = f"{process.name} with {controller.name}"
    return Program(name, state, inputs, parameters, recorded, block)


def _spilt(
    builder: BlockBuilder, process: Process, value: dict[str, int], moved: tuple[int, ...]
) -> tuple[int, ...]:
    """Return the next state of a motion where tanks spill, and behind it what they have spilt."""
    names = [signal.name for signal in process.motion.contents]
    kept, spilt = append_rims(builder, process, value, dict(zip(names, moved, strict=False)))
    return (*(kept[name] for name in names), *moved[len(names) :], *spilt)


def true_name(measurement: Signal) -> str:
    """Return the name of what a sensor would read without noise, resolution and limits."""
    return path(measurement, TRUE)


def _measure(
    builder: BlockBuilder, process: Process, value: dict[str, int], contents: list[int]
) -> dict[str, int]:
    """Read the sensors: name states and what is shown; return what they read without noise."""
    parameters = [value[p.name] for p in process.parameters]
    state = inline(builder, process.motion.to_state, [*contents, *parameters], fused=True)
    value |= {x.name: v for x, v in zip(process.state, state, strict=True)}
    true = inline(builder, process.measure, [*state, *parameters], fused=True)
    noisy = [
        builder.operation("add", reading, value[f"{y.name}.noise"])
        for y, reading in zip(process.measurements, true, strict=True)
    ]
    shown = inline(builder, process.display, noisy)
    value |= {y.name: v for y, v in zip(process.measurements, shown, strict=True)}
    return {y.name: v for y, v in zip(process.measurements, true, strict=True)}


def _control(
    builder: BlockBuilder,
    process: Process,
    controller: Controller,
    value: dict[str, int],
    time_step: int,
    in_single: Program | None,
) -> list[int]:
    """Compute the step law in place, name its outputs in the loop, and return its next state."""
    law, ways = controller.law, wire_conversions(controller, process)

    def passed(name: str, number: int) -> int:
        if name not in ways:
            return number
        return builder.operation(ways[name].code, number, builder.constant(ways[name].number))

    wires, told = controller.input_wires, controller.output_wires
    given = {name: passed(name, value[wire]) for name, wire in wires.items()}
    given["time_step"] = time_step
    arguments = [
        *(value[controller_name(entry.name)] for entry in law.state),
        *(given[signal.name] for signal in law.inputs),
        *(value[controller_name(signal.name)] for signal in law.parameters),
    ]
    if in_single is None:
        results = inline(builder, law.function, arguments)
    else:
        for place in in_single.input_arguments:
            arguments[place] = builder.operation(TO_SINGLE, arguments[place])
        results = append_in_place(builder, in_single.block, arguments)
    outputs = zip(law.outputs, results[len(law.state) :], strict=False)
    value |= {told[s.name]: passed(s.name, n) for s, n in outputs}
    return results[: len(law.state)]


def loop_inputs(process: Process) -> tuple[Signal, ...]:
    """Return the inputs of a closed loop, at rest in automatic with sound sensors."""
    controlled = [process.signal(name) for name in process.controlled]
    return (
        *(Signal(f"{y.name}.setpoint", y.unit, y.display_unit, y.low, y.high) for y in controlled),
        *process.disturbances,
        *(Signal(f"{y.name}.noise", y.unit, y.display_unit) for y in process.measurements),
        *(
            Signal(f"{y.name}.sensor", kind="boolean", low=0.0, high=1.0, initial=1.0)
            for y in process.measurements
        ),
        *(
            Signal(f"{u.name}.mode", kind="integer", low=0.0, high=2.0, initial=1.0)
            for u in process.inputs
        ),
        *(
            Signal(f"{u.name}.{what}", u.unit, u.display_unit, u.low, u.high, u.initial)
            for what in ("manual", "tracking")
            for u in process.inputs
        ),
    )


def free_inputs(controller: Controller) -> tuple[Signal, ...]:
    """Return the inputs of a law that nothing of the process drives, named as in the loop."""
    return tuple(
        replace(
            signal,
            name=controller_name(signal.name),
            initial=controller.free_inputs[signal.name],
        )
        for signal in controller.law.inputs
        if signal.name in controller.free_inputs
    )


def _renamed(entry: Signal | DelayRing) -> Signal | DelayRing:
    if isinstance(entry, DelayRing):
        return replace(entry, signal=replace(entry.signal, name=controller_name(entry.name)))
    return replace(entry, name=controller_name(entry.name))
