"""The program of a test project: it calls alarms, controller and process, one after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from clepsydra.base.conversion import conversion
from clepsydra.base.signal import Signal, identifier, path
from clepsydra.controllers.alarms.law import COMMAND
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.deploy.printing.declarations import Variable, declared
from clepsydra.deploy.printing.expressions import Expression, constant, variable
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.pou import Section, Unit
from clepsydra.deploy.structured_text.statements import StructuredText
from clepsydra.program.program import Program


@dataclass(frozen=True)
class Beside:
    """Alarms that stand beside a controller in its test project.

    Parameters
    ----------
    program : Program
    wires : mapping
        Its signals to those of the loop, as a project has them of its controller.
    origin : Origin, optional
    """

    program: Program
    wires: Mapping[str, str]
    origin: Origin | None = None


@dataclass(frozen=True)
class Wiring:
    """How a block of a test project gets its inputs; what is in none of them is set by hand.

    Parameters
    ----------
    read : mapping
        Input to the output of the block before it in the loop.
    rest : mapping
        Input to its value at the start.
    """

    read: Mapping[str, str]
    rest: Mapping[str, float]


@dataclass(frozen=True)
class _Call:
    """A call: a block, its instance, what it reads of which other one, and who sets the rest."""

    block: Program
    instance: str
    reads: Mapping[str, tuple[str, Signal]]
    rest: Mapping[str, float]
    by_hand: dict[str, Variable]
    about: str


def loop_program(
    controller: Program,
    process: Program,
    wiring: tuple[Wiring, Wiring],
    wording: StructuredText,
    alarms: tuple[Program, Wiring] | None = None,
) -> Unit:
    """Return the program that runs a controller against a process; all in its precision.

    Parameters
    ----------
    wiring : tuple of Wiring
        Of the controller, which reads the process, and the other way round.
    alarms : tuple, optional
        A program of alarms, which reads the process too, and how; the controller reads their
        interlocks, and they what it moved in the last scan.
    """
    dialect, names, mark = wording.dialect, wording.names, wording.dialect.local_mark
    name = names.new(f"{controller.name}_test")
    first, second = names.new("controller"), names.new("plant")
    third = names.new("alarms") if alarms else ""

    def new(signal: Signal, start: float) -> Variable:
        named = at_port(replace(signal, initial=start))
        return replace(declared([named], wording)[0], name=names.new(signal.variable))

    def converted(source: str, unit: str, wanted: str) -> str:
        way = conversion(unit, wanted)
        if way is None:
            return source
        return wording.expression(Expression(way.code, (variable(source), constant(way.number))))

    shown, told = ({s.name: s for s in each.outputs} for each in (process, controller))
    to_controller, to_process = wiring
    reads = {name: (second, shown[wire]) for name, wire in to_controller.read.items()}
    by_hand: dict[str, Variable] = {}
    moved: dict[str, Variable] = {}
    calls = []
    if alarms:
        block, own = alarms
        reads |= {s.name: (third, s) for s in block.outputs if _asked(s, controller)}
        for signal in block.inputs:
            out = path(signal.owner, "out")
            if signal.part == COMMAND and out in told:
                start = to_controller.rest.get(path(signal.owner, "manual"), signal.initial)
                moved[out] = by_hand[signal.name] = new(signal, start)
        seen_by_alarms = {name: (second, shown[wire]) for name, wire in own.read.items()}
        about = "the alarms look at the plant as it is at this scan, before the controller"
        calls.append(_Call(block, third, seen_by_alarms, own.rest, by_hand, about))
    about = "the controller reads the plant as it is at this scan"
    calls.append(_Call(controller, first, reads, to_controller.rest, by_hand, about))
    reads = {name: (first, told[wire]) for name, wire in to_process.read.items()}
    about = "and the plant moves on to the next scan"
    calls.append(_Call(process, second, reads, to_process.rest, {}, about))

    body: list[str] = []
    given: list[Variable] = []
    for call in calls:
        arguments = []
        for signal in call.block.inputs:
            if signal.name in call.reads:
                instance, read = call.reads[signal.name]
                source, unit = f"{mark}{instance}.{identifier(read.name)}", read.unit
            else:
                if signal.name not in call.by_hand:
                    start = call.rest.get(signal.name, signal.initial)
                    call.by_hand[signal.name] = new(signal, start)
                    given.append(call.by_hand[signal.name])
                source, unit = f"{mark}{call.by_hand[signal.name].name}", at_port(signal).unit
            arguments.append(f"  {signal.identifier} := {converted(source, unit, signal.unit)}")
        called = [f"{mark}{call.instance}(", *",\n".join(arguments).splitlines(), ");"]
        body += [dialect.commented(call.about), *called]
    seen = []
    for out, kept in moved.items():
        body.append(f"{mark}{kept.name} := {mark}{first}.{identifier(out)};")
        seen.append(kept)
    for call in calls:
        for inside, signal in {each.variable: each for each in call.block.outputs}.items():
            seen.append(new(signal, signal.initial))
            value = converted(f"{mark}{call.instance}.{inside}", signal.unit, at_port(signal).unit)
            body.append(f"{mark}{seen[-1].name} := {value};")
    words = {first: "the controller", second: "the simulated process", third: "its alarms"}
    instances = tuple(
        Variable(each.instance, each.block.name, comment=words[each.instance], is_block=True)
        for each in calls
    )
    groups = (
        ("instances", instances),
        ("what an engineer sets or forces", tuple(given)),
        ("what there is to see", tuple(seen)),
    )
    return Unit("PROGRAM", name, (), (Section("VAR", "", groups),), tuple(body))


def _asked(signal: Signal, controller: Program) -> bool:
    """Whether a controller asks for what alarms tell."""
    return any(each.name == signal.name for each in controller.inputs)
