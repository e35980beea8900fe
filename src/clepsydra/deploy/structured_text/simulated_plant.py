"""A program that runs a controller against the simulated process, on the plant's own computer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from clepsydra.base.conversion import conversion
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, identifier
from clepsydra.base.units import convertible, from_si
from clepsydra.controllers.blocks.status import Mode
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.deploy.printing.declarations import Variable, declared
from clepsydra.deploy.printing.expressions import Expression, constant, variable
from clepsydra.deploy.structured_text.pou import Section, Unit
from clepsydra.deploy.structured_text.statements import StructuredText
from clepsydra.program.program import Program


@dataclass(frozen=True)
class Wiring:
    """Which signals of a controller and a process are wired to each other.

    Parameters
    ----------
    measured : mapping
        Input of the controller to the output of the process that it reads.
    moved : mapping
        Input of the process to the output of the controller that moves it.
    rest : mapping
        Input of the controller that nothing moves to its value at the start.

    Examples
    --------
    >>> Wiring({"level_1.pv": "level_1"}, {"pump_1": "pump_1.out"}, {}).moved
    {'pump_1': 'pump_1.out'}
    """

    measured: Mapping[str, str]
    moved: Mapping[str, str]
    rest: Mapping[str, float]


def wired(
    controller: Program, process: Program, wires: Mapping[str, str], sampling_period: float
) -> Wiring:
    """Return the wiring of two programs.

    Parameters
    ----------
    controller, process : Program
    wires : mapping
        Signal of the controller to the loop's signal, as `Controller.input_wires` and
        `Controller.output_wires` have it: "level_1.pv" to "level_1", "level_1.sp" to
        "level_1.setpoint", "pump_1.out" to "pump_1".
    sampling_period : float
        [s]

    Raises
    ------
    InputError
        A measurement or a manipulated value of the controller is wired to nothing that the
        process has.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (), (Signal("level_1.pv"), Signal("level_1.sp")), (),
    ...               (Signal("pump_1.out"),), Block(2, (), (0,)))
    >>> tank = Program("tank", (), (Signal("pump_1"),), (), (Signal("level_1", initial=0.4),),
    ...                Block(1, (), (0,)))
    >>> wires = {"level_1.pv": "level_1", "level_1.sp": "level_1.setpoint",
    ...          "pump_1.out": "pump_1"}
    >>> wired(law, tank, wires, 1.0).rest
    {'level_1.sp': 0.4}
    """
    shown = {signal.name: signal for signal in process.outputs}
    driven = {signal.name: signal for signal in process.inputs}
    known = shown | driven
    measured, moved, rest = {}, {}, {}
    fixed = {"mode": float(Mode.AUTOMATIC), "sensor": 1.0}
    for signal in controller.inputs:
        wire = wires.get(signal.name, "")
        base, _, what = wire.rpartition(".")
        if signal.part == "pv" or wire in shown:
            _check(wire, shown, f"{controller.name}, {signal.name}", "an output")
            measured[signal.name] = wire
        elif what in ("setpoint", "manual", "tracking") and base in known:
            start, unit = known[base].initial, known[base].unit
            converts = convertible(signal.unit, unit)
            rest[signal.name] = from_si(start, unit, signal.unit) if converts else start
        elif what in fixed or signal.name == "time_step":
            rest[signal.name] = fixed.get(what, sampling_period)
    for signal in controller.outputs:
        wire = wires.get(signal.name, "")
        if signal.part == "out" or wire in driven:
            _check(wire, driven, f"{controller.name}, {signal.name}", "an input")
            moved[wire] = signal.name
    return Wiring(measured, moved, rest)


def _check(wire: str, known: Mapping[str, Signal], place: str, what: str) -> None:
    if wire not in known:
        raise InputError(
            f"test project, {place}", wire or "no wire",
            f"{what} of the process: {', '.join(known)}", "wire it as in the loop",
        )  # fmt: skip


def loop_program(
    controller: Program, process: Program, wiring: Wiring, wording: StructuredText
) -> Unit:
    """Return the program that runs a controller against a process.

    Parameters
    ----------
    controller, process : Program
        In the precision of the text.
    wiring : Wiring
    wording : StructuredText
        Of the program, which gets its name and those of its variables in its scope.

    Examples
    --------
    See `clepsydra.deploy.structured_text.project.print_test_project`.
    """
    dialect, names, mark = wording.dialect, wording.names, wording.dialect.local_mark
    name = names.new(f"{controller.name}_test")
    first, second = names.new("controller"), names.new("plant")

    def new(signal: Signal, start: float) -> Variable:
        named = at_port(replace(signal, initial=start))
        return replace(declared([named], wording)[0], name=names.new(signal.variable))

    def converted(source: str, unit: str, wanted: str) -> str:
        way = conversion(unit, wanted)
        if way is None:
            return source
        return wording.expression(Expression(way.code, (variable(source), constant(way.number))))

    body: list[str] = []
    given: list[Variable] = []
    reads = "the controller reads the plant as it is at this scan"
    moves = "and the plant moves on to the next scan"
    pair = (controller, first, wiring.measured, reads), (process, second, wiring.moved, moves)
    for (block, instance, wires, about), (other, its, *_) in zip(pair, pair[::-1], strict=True):
        units = {signal.name: signal.unit for signal in other.outputs}
        arguments = []
        for signal in block.inputs:
            if wire := wires.get(signal.name):
                source, unit = f"{mark}{its}.{identifier(wire)}", units[wire]
            else:
                given.append(new(signal, wiring.rest.get(signal.name, signal.initial)))
                source, unit = f"{mark}{given[-1].name}", at_port(signal).unit
            arguments.append(f"  {signal.identifier} := {converted(source, unit, signal.unit)}")
        call = [f"{mark}{instance}(", *",\n".join(arguments).splitlines(), ");"]
        body += [dialect.commented(about), *call]
    seen = []
    for block, instance, *_ in pair:
        for inside, signal in {each.variable: each for each in block.outputs}.items():
            seen.append(new(signal, signal.initial))
            value = converted(f"{mark}{instance}.{inside}", signal.unit, at_port(signal).unit)
            body.append(f"{mark}{seen[-1].name} := {value};")
    instances = (
        Variable(first, controller.name, comment="the controller", is_block=True),
        Variable(second, process.name, comment="the simulated process", is_block=True),
    )
    groups = (
        ("instances", instances),
        ("what an engineer sets or forces", tuple(given)),
        ("what there is to see", tuple(seen)),
    )
    return Unit("PROGRAM", name, (), (Section("VAR", "", groups),), tuple(body))
