"""Tags at the edge of an export: they take the place of the names of the process file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.tags import explained, tagging
from clepsydra.controllers.controller import Controller
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.program.operation import Operation
from clepsydra.program.program import Call, Program, Statement
from clepsydra.program.routine import RoutineCall


def process_tagging(process: Process) -> Callable[[str], str]:
    """Return the function from a name of a process to the one with tags.

    Examples
    --------
    >>> import clepsydra as cl
    >>> process = replace(cl.load("quadruple-tank").process, tags={"pump_1": "P101"})
    >>> process_tagging(process)("pump_1.gain")
    'P101.gain'
    """
    return tagging(process.tags, _names(process))


@dataclass(frozen=True, eq=False)
class TaggedLaw:
    """The names of a controller's law with the tags of its process.

    What a law calls otherwise than the process signal that it is wired to has its tag too.

    Parameters
    ----------
    controller : Controller
    process : Process

    Raises
    ------
    InputError
        Two measurements of the law are wired to one signal, so that both would have its tag.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> process = replace(plant.process, tags={"level_1": "LIC101", "pump_1": "P101"})
    >>> tagged = TaggedLaw(cl.design.simc(plant), process)
    >>> tagged.name("level_1.sp"), tagged.wires["LIC101.pv"]
    ('LIC101.sp', 'LIC101')
    >>> tagged.program(tagged.controller.program()).outputs[0].description
    'voltage of pump_1 (P101)'
    """

    controller: Controller
    process: Process

    @cached_property
    def _wired(self) -> dict[str, str]:
        """What the law calls the signals that it measures and moves, to the process signal."""
        controller = self.controller
        measured = {Signal(name): wire for name, wire in controller.input_wires.items()}
        moved = {Signal(name): wire for name, wire in controller.output_wires.items()}
        found = {end.owner: wire for end, wire in measured.items() if end.part == "pv"}
        return found | {end.owner: wire for end, wire in moved.items() if end.part == "out"}

    @cached_property
    def name(self) -> Callable[[str], str]:
        """The function from a name of the law to the one with tags."""
        tags, owners = self.process.tags, dict[str, str]()
        for owner, wire in self._wired.items():
            if wire in tags and owners.setdefault(wire, owner) != owner:
                raise InputError(
                    f"{self.controller.name}, tag of {wire}",
                    tags[wire],
                    f"one measurement of the law that is wired to {wire}, since {owners[wire]} "
                    f"and {owner} would both have its tag",
                    "wire them to different signals, or leave the tag out",
                )
        own = {owner: tags.get(wire, owner) for owner, wire in self._wired.items()}
        return tagging({**tags, **own}, _names(self.process))

    def program(self, program: Program) -> Program:
        """Return a program of the law with tags."""
        return tagged_program(
            replace(
                program,
                inputs=tuple(map(self._explained, program.inputs)),
                outputs=tuple(map(self._explained, program.outputs)),
            ),
            self.name,
        )

    def _explained(self, signal: Signal) -> Signal:
        wire = self._wired.get(signal.owner, "") if signal.part in ("pv", "out") else ""
        return _explained(signal, wire, self.process.tags)

    @property
    def wires(self) -> dict[str, str]:
        """The law's signals to those of its loop, both with tags."""
        wires = self.controller.input_wires | self.controller.output_wires
        loop = process_tagging(self.process)
        return {self.name(name): loop(wire) for name, wire in wires.items()}


def tagged_point(point: OperatingPoint) -> OperatingPoint:
    """Return an operating point whose process shows its tags, for the exports of the process.

    Examples
    --------
    >>> import clepsydra as cl
    >>> point = cl.load("three-tanks").point
    >>> tags = {"level_1": "LIC101"}
    >>> found = tagged_point(replace(point, process=replace(point.process, tags=tags)))
    >>> signal = found.process.measurements[0]
    >>> signal.name, signal.description
    ('LIC101', 'measured level of tank_1, level_1 (LIC101)')
    """
    process, motion = point.process, point.process.motion
    tagged = process_tagging(process)

    def named(signals: tuple[Signal, ...]) -> tuple[Signal, ...]:
        told = (_explained(signal, signal.name, process.tags) for signal in signals)
        return tuple(replace(signal, name=tagged(signal.name)) for signal in told)

    found = replace(
        process,
        state=named(process.state),
        inputs=named(process.inputs),
        disturbances=named(process.disturbances),
        measurements=named(process.measurements),
        parameters=named(process.parameters),
        reporting={tagged(name): each for name, each in process.reporting.items()},
        motion=replace(
            motion,
            contents=named(motion.contents),
            totals=named(motion.totals),
            memories=named(motion.memories),
            delays=tuple(replace(each, name=tagged(each.name)) for each in motion.delays),
            events=tuple(each._replace(name=tagged(each.name)) for each in motion.events),
        ),
    )
    return replace(point, process=found)


def tagged_program(program: Program, tagged: Callable[[str], str]) -> Program:
    """Return a program with other paths: of its signals, its instances and what they call.

    Parameters
    ----------
    program : Program
    tagged : callable
        See `clepsydra.base.tags.tagging`.

    Examples
    --------
    >>> from clepsydra.base.tags import tagging
    >>> ports = {"state": (), "inputs": (Signal("level.pv"),), "parameters": ()}
    >>> from clepsydra.program.program import Block
    >>> program = Program("same", outputs=(Signal("pump.out"),), block=Block(1, (), (0,)), **ports)
    >>> tagged_program(program, tagging({"level": "LIC101"}, ())).inputs[0].name
    'LIC101.pv'
    """

    def path(name: str) -> str:
        # What belongs to nothing is a port of a block, or one of the whole law.
        return tagged(name) if "." in name else name

    def statement(each: Statement) -> Statement:
        if isinstance(each, (Operation, RoutineCall)):
            return each
        if isinstance(each, Call):
            called = tagged_program(each.program, tagged)
            return replace(each, instance=path(each.instance), program=called)
        return replace(each, name=path(each.name))

    named = program.with_signals(lambda each: replace(each, name=path(each.name)))
    names = {value: path(name) for value, name in program.names.items()}
    return replace(named, block=named.block.with_statements(statement), names=names)


def _names(process: Process) -> list[str]:
    groups = (process.state, process.inputs, process.disturbances, process.measurements)
    return [signal.name for group in groups for signal in group]


def _explained(signal: Signal, name: str, tags: Mapping[str, str]) -> Signal:
    return explained(signal, name, tags[name]) if name in tags else signal
