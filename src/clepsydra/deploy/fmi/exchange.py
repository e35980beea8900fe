"""A process as a model for model exchange: its derivatives and events, for the importer."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.model import FmuModel, FmuVariable, output_dependencies, variables_of
from clepsydra.deploy.fmi.model_header import call_beside, call_step
from clepsydra.deploy.fmi.process import held_signals, shown_contents
from clepsydra.deploy.printing.origin import Origin
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.process.process import Process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Block, Program
from clepsydra.program.reader import inline


def exchange_model(point: OperatingPoint, origin: Origin) -> FmuModel:
    """Return the model of a process that the importer integrates.

    Continuous states are the contents of the process: levels, volumes, amounts, positions.
    Switches are event indicators, whose event happens where one becomes zero or positive; what
    they set is remembered. What follows the motion, as a stem with play does, is remembered in
    event mode too: at the end of an integrator step the importer is asked for an event where
    the derivatives or outputs would be others with it.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts.
    origin : Origin

    Raises
    ------
    InputError
        The process has transport delays or late sensors, which no ordinary differential equation
        has.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> point = find_equilibrium(load_process("quadruple-tank"))
    >>> model = exchange_model(point, Origin("the process", "quadruple-tank", "", 1.0))
    >>> [variable.name for variable in model.derivatives][:2]
    ['der(tank_1.level)', 'der(tank_2.level)']
    """
    process = point.process
    _refuse_delays(process)
    equations = _Equations(point)
    motion = equations.motion()
    members = {s.name: f"parameters.{s.identifier}" for s in process.parameters}
    members |= {s.name: f"inputs.{s.identifier}" for s in motion.inputs}
    size, events = len(process.motion.contents), len(process.motion.events)
    contents, memories = motion.inputs[:size], list(motion.inputs[size : size + equations.memories])
    for place in equations.followed:
        words = f"{memories[place].description}, as the last event left it"
        memories[place] = replace(memories[place], description=words)
    depends = output_dependencies(motion)
    results = variables_of(motion.outputs, "outputs", "output", "continuous", depends)
    derivatives = [
        replace(
            result,
            signal=replace(result.signal, name=f"der({content.name})"),
            causality="local",
            derivative_of=content.name,
        )
        for result, content in zip(results[:size], contents, strict=True)
    ]
    indicators = [replace(r, causality="local") for r in results[size : size + events]]
    shown = shown_contents(process)
    variables: list[FmuVariable] = [
        *variables_of(process.parameters, "parameters", "parameter", "tunable"),
        *variables_of(motion.inputs[size + equations.memories :], "inputs", "input", "continuous"),
        *(
            replace(content, causality="output" if content.name in shown else "local")
            for content in variables_of(contents, "inputs", "local", "continuous")
        ),
        *variables_of(memories, "inputs", "local", "discrete"),
        *derivatives,
        *indicators,
        *results[size + events :],
    ]
    words = "Derivatives, event indicators and outputs of the present states and inputs."
    functions, beside = [call_step("model_show", words, motion)], []
    for needed, make, function, comment in (
        (events, equations.switch, "model_switch", "What the events that happen set."),
        (equations.followed, equations.update, "model_update", "What a step leaves behind."),
    ):
        if needed:
            beside.append(make())
            functions.append(call_beside(function, comment, beside[-1], members))
    return FmuModel(
        programs=(motion, *beside),
        variables=tuple(variables),
        functions="\n".join(functions),
        step=0.0,
        scans=False,
        title=process.title,
        origin=origin,
        indicators=tuple(indicator.name for indicator in indicators),
        followed=tuple(memories[place].name for place in equations.followed),
    )


def _refuse_delays(process: Process) -> None:
    found = [f"{each.name}, a transport delay of {each.time:g} s" for each in process.motion.delays]
    found += [f"{name}, which is told late" for name in process.reporting]
    if found:
        raise InputError(
            f"model exchange FMU of {process.name}",
            found[0],
            "a process without delays: an importer's integrator keeps no past",
            "write the FMU for co-simulation, which keeps it",
        )


class _Equations:
    """The programs over contents, memories, inputs, disturbances and parameters."""

    def __init__(self, point: OperatingPoint) -> None:
        process = point.process
        self._process, self._name = process, process.file_stem.replace("-", "_")
        at = motion_at_rest(point) | point.as_dict()
        held = (*process.motion.contents, *process.motion.memories)
        self.memories = len(process.motion.memories)
        self._inputs = (
            *held_signals(process, [replace(s, initial=at[s.name]) for s in held]),
            *(replace(s, initial=at[s.name]) for s in (*process.inputs, *process.disturbances)),
        )
        self._size = len(self._inputs) + len(process.parameters)
        rates = process.motion.rates
        self._symbols = [ca.SX.sym(name, rates.numel_in(k)) for k, name in enumerate("czmudp")]

    def motion(self) -> Program:
        """Derivatives of the contents, guards of the events, other states, measurements."""
        process, motion = self._process, self._process.motion
        builder = BlockBuilder(self._size)
        everything = list(range(self._size))
        contents = everything[: len(motion.contents)]
        parameters = everything[len(self._inputs) :]
        rates = inline(builder, motion.rates, everything)[: len(contents)]
        guards = inline(builder, motion.guards, everything)
        states = inline(builder, motion.to_state, [*contents, *parameters])
        measured = inline(builder, process.show, [*states, *parameters])
        shown = shown_contents(process)
        others = [place for place, s in enumerate(process.state) if s.name not in shown]
        outputs = (
            *(
                Signal(f"derivative.{s.name}", _rate_unit(s.unit), description=f"of {s.name}")
                for s in motion.contents
            ),
            *(Signal(f"guard.{event.name}", description=event.words) for event in motion.events),
            *(process.state[place] for place in others),
            *process.measurements,
        )
        block = builder.finish([*rates, *guards, *(states[k] for k in others), *measured])
        return self._program("model_exchange", outputs, block)

    @property
    def followed(self) -> list[int]:
        """The places of those memories that may be others at the end of a step."""
        following = ca.densify(self._process.motion.updates(*self._symbols))
        held = self._symbols[2]
        return [k for k in range(self.memories) if not ca.is_equal(following[k], held[k], 1)]

    def switch(self) -> Program:
        """The memories after the events whose guards are zero or positive."""
        motion, held = self._process.motion, self._symbols
        after = motion.resets(motion.guards(*held) >= 0, *held)
        return self._of_memories("switch", ca.Function("switch", held, [ca.densify(after)]))

    def update(self) -> Program:
        """The memories at the end of an integration step."""
        return self._of_memories("update", self._process.motion.updates)

    def _of_memories(self, kind: str, function: ca.Function) -> Program:
        builder = BlockBuilder(self._size)
        block = builder.finish(inline(builder, function, range(self._size)))
        first = len(self._process.motion.contents)
        return self._program(kind, self._inputs[first : first + self.memories], block)

    def _program(self, kind: str, outputs: tuple[Signal, ...], block: Block) -> Program:
        return Program(
            f"{self._name}_{kind}", (), self._inputs, self._process.parameters, outputs, block
        )


def _rate_unit(unit: str) -> str:
    if unit == "1":
        return "1/s"
    return f"{unit[:-2]}" if unit.endswith(" s") else f"{unit}/s"
