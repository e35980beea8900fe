"""A program that runs a controller against the simulated process, on the plant's own computer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from clepsydra import __version__
from clepsydra.base.conversion import Conversion, conversion
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal, identifier
from clepsydra.base.units import convertible, from_si
from clepsydra.controllers.blocks.mode import Mode
from clepsydra.deploy.printing.expressions import Expression, variable
from clepsydra.deploy.printing.heading import comment
from clepsydra.deploy.printing.identifiers import Identifiers, check_distinct
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision, in_precision
from clepsydra.deploy.structured_text.dialect import Dialect
from clepsydra.deploy.structured_text.interface import Interface
from clepsydra.deploy.structured_text.pou import Section, Unit, Variable
from clepsydra.deploy.structured_text.time_literal import time_literal
from clepsydra.deploy.structured_text.wording import Wording
from clepsydra.program.program import Program

_STEP = "  "


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
    ways : mapping
        Input, of either, that has another unit than what it is wired to, to how it gets there.

    Examples
    --------
    >>> Wiring({"level_1.pv": "level_1"}, {"pump_1": "pump_1.out"}, {}).moved
    {'pump_1': 'pump_1.out'}
    """

    measured: Mapping[str, str]
    moved: Mapping[str, str]
    rest: Mapping[str, float]
    ways: Mapping[str, Conversion] = field(default_factory=dict)


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
    measured, moved, rest, ways = {}, {}, {}, {}
    for signal in controller.inputs:
        wire = wires.get(signal.name, "")
        base, _, what = wire.rpartition(".")
        if signal.part == "pv" or wire in shown:
            _check(wire, shown, f"{controller.name}, {signal.name}", "an output")
            measured[signal.name] = wire
            ways[signal.name] = conversion(shown[wire].unit, signal.unit)
        elif what in ("setpoint", "manual", "tracking") and base in known:
            start, unit = known[base].initial, known[base].unit
            converts = convertible(signal.unit, unit)
            rest[signal.name] = from_si(start, unit, signal.unit) if converts else start
        elif what == "mode":
            rest[signal.name] = float(Mode.AUTOMATIC)
        elif what == "sensor":
            rest[signal.name] = 1.0
        elif signal.name == "time_step":
            rest[signal.name] = sampling_period
    for signal in controller.outputs:
        wire = wires.get(signal.name, "")
        if signal.part == "out" or wire in driven:
            _check(wire, driven, f"{controller.name}, {signal.name}", "an input")
            moved[wire] = signal.name
            ways[wire] = conversion(signal.unit, driven[wire].unit)
    return Wiring(measured, moved, rest, {n: way for n, way in ways.items() if way is not None})


def _check(wire: str, known: Mapping[str, Signal], place: str, what: str) -> None:
    if wire not in known:
        raise InputError(
            f"test project, {place}", wire or "no wire",
            f"{what} of the process: {', '.join(known)}", "wire it as in the loop",
        )  # fmt: skip


@dataclass(frozen=True)
class LoopProgram:
    """The program, and the task that it runs in.

    Parameters
    ----------
    unit : Unit
    interval : str
        TIME of the task.

    Examples
    --------
    >>> LoopProgram(Unit("PROGRAM", "law_test", (), (), ()), "T#1s").interval
    'T#1s'
    """

    unit: Unit
    interval: str


def make_loop_program(
    controller: Program,
    process: Program,
    wires: Mapping[str, str],
    sampling_period: float,
    dialect: Dialect,
    precision: Precision,
    origin: Origin | None,
) -> LoopProgram:
    """Return the program that runs a controller against a process.

    Raises
    ------
    InputError
        The two blocks have the same name, the wires do not fit them, or a TIME cannot hold the
        sampling period.
    """
    interval = time_literal(sampling_period)
    named = [(p.name, f"the block {p.name}") for p in (controller, process)]
    check_distinct(named, "Structured Text", ignore_case=True)
    controller, process = (in_precision(p, precision) for p in (controller, process))
    wiring = wired(controller, process, wires, sampling_period)
    maker = _Maker(controller, process, wiring, dialect, precision)
    return LoopProgram(maker.unit(interval, origin), interval)


class _Maker:
    def __init__(
        self,
        controller: Program,
        process: Program,
        wiring: Wiring,
        dialect: Dialect,
        precision: Precision,
    ) -> None:
        self._controller, self._process, self._wiring = controller, process, wiring
        self._dialect = dialect
        self._names = Identifiers(
            [*dialect.all_words, controller.name, process.name], ignore_case=True
        )
        self._wording = Wording(dialect, precision, self._names)
        self._interface = Interface(self._wording, None)
        self._name = self._names.new(f"{controller.name}_test")
        self._instances = self._names.new("controller"), self._names.new("plant")

    def unit(self, interval: str, origin: Origin | None) -> Unit:
        controller, process = self._controller, self._process
        first, second = self._instances
        given = self._given(controller.inputs, self._wiring.measured)
        disturbed = self._given(process.inputs, self._wiring.moved)
        seen = self._seen(controller.outputs) | self._seen(process.outputs)
        blocks = (
            Variable(first, controller.name, comment="the controller", is_block=True),
            Variable(second, process.name, comment="the simulated process", is_block=True),
        )
        section = Section(
            "VAR",
            "",
            (
                ("instances", blocks),
                ("what an engineer sets or forces", tuple((given | disturbed).values())),
                ("what there is to see", tuple(variable for variable, _ in seen.values())),
            ),
        )
        body = [
            self._dialect.commented("the controller reads the plant as it is at this scan"),
            *self._call(first, controller.inputs, self._wiring.measured, second, given),
            self._dialect.commented("and the plant moves on to the next scan"),
            *self._call(second, process.inputs, self._wiring.moved, first, disturbed),
        ]
        mark = self._dialect.local_mark
        for signals, instance in ((controller.outputs, first), (process.outputs, second)):
            for signal in signals:
                variable, _ = seen[signal.name]
                body.append(f"{mark}{variable.name} := {mark}{instance}.{signal.identifier};")
        return Unit("PROGRAM", self._name, self._head(interval, origin), (section,), tuple(body))

    def _given(self, signals: Sequence[Signal], wired: Mapping[str, str]) -> dict[str, Variable]:
        """Declare what nothing drives."""
        found = {}
        for signal in signals:
            if signal.name in wired:
                continue
            start = self._wiring.rest.get(signal.name, signal.initial)
            found[signal.name] = self._declared(signal, start)
        return found

    def _seen(self, signals: Sequence[Signal]) -> dict[str, tuple[Variable, Signal]]:
        return {signal.name: (self._declared(signal, signal.initial), signal) for signal in signals}

    def _declared(self, signal: Signal, start: float) -> Variable:
        named = Signal(
            self._names.new(signal.identifier),
            signal.unit,
            low=signal.low,
            high=signal.high,
            initial=start,
            kind=signal.kind,
            description=signal.description,
        )
        declared = self._interface.variable(named)
        return Variable(declared.name, declared.type, declared.initial, comment=comment(named))

    def _call(
        self,
        instance: str,
        signals: Sequence[Signal],
        wired: Mapping[str, str],
        other: str,
        given: Mapping[str, Variable],
    ) -> list[str]:
        mark = self._dialect.local_mark
        arguments = []
        for signal in signals:
            if signal.name in wired:
                name = identifier(wired[signal.name])
                source = self._converted(signal, f"{mark}{other}.{name}")
            else:
                source = f"{mark}{given[signal.name].name}"
            arguments.append(f"{signal.identifier} := {source}")
        lines = [f"{_STEP}{argument}," for argument in arguments[:-1]]
        lines += [f"{_STEP}{argument}" for argument in arguments[-1:]]
        return [f"{mark}{instance}(", *lines, ");"]

    def _converted(self, signal: Signal, source: str) -> str:
        way = self._wiring.ways.get(signal.name)
        if way is None:
            return source
        number = Expression("constant", number=way.number)
        return self._wording.expression(Expression(way.code, (variable(source), number)))

    def _head(self, interval: str, origin: Origin | None) -> tuple[str, ...]:
        name = self._controller.name
        lines = [
            f"{self._name}: {name} at work on the simulated {self._process.name}.",
            f"Printed by Clepsydra {__version__}.",
            *(origin.lines() if origin else ()),
            f"Call it in a cyclic task of {interval}; it starts at rest. A change of a setpoint or",
            "a disturbance here moves the plant as the simulation of Clepsydra does.",
            "For tests only: delete it and the simulated process before the plant is connected.",
        ]
        if not self._dialect.programs:
            lines.insert(-1, "It is a block, to be called from a cyclic interrupt such as OB30.")
        return tuple(lines)
