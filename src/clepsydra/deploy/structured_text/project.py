"""A project that runs a controller against the simulated process, as text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from clepsydra import __version__
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, from_si
from clepsydra.controllers.alarms.interlock import INTERLOCK
from clepsydra.controllers.blocks.status import Mode
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import Dialect, dialect_of
from clepsydra.deploy.structured_text.loop_program import Beside, Wiring, loop_program
from clepsydra.deploy.structured_text.pou import Unit, unit_text
from clepsydra.deploy.structured_text.printer import function_blocks
from clepsydra.deploy.structured_text.statements import StructuredText
from clepsydra.deploy.structured_text.time_literal import time_literal
from clepsydra.program.precision import Precision, in_precision
from clepsydra.program.program import Program

#: Names that the runtime of OpenPLC looks for in what its compiler makes.
CONFIGURATION, RESOURCE, TASK = "Config0", "Res0", "sampling"


@dataclass(frozen=True)
class Project:
    """A controller, a process, and a program that runs one against the other.

    The program calls the controller with what the process showed at the end of the last
    sampling period, and then the process with what the controller wants: that is the loop as
    `clepsydra.loop.loop.Loop` runs it. Setpoints, modes, values of manual and tracking and
    disturbances are variables that an engineer can set or force; they start at rest.

    Parameters
    ----------
    controller : Program
        Of a controller, best in its plant shell.
    process : Program
        See `clepsydra.deploy.process_program.process_program`.
    wires : mapping
        `Controller.input_wires` and `Controller.output_wires` together.
    sampling_period : float
        Of the task [s].
    origin, process_origin : Origin, optional
    precision : {"double", "single"}
    dialect : {"codesys", "matiec", "scl"}
    alarms : Beside, optional
        The alarms of the process, called before the controller, whose interlocks they are.
    """

    controller: Program
    process: Program
    wires: Mapping[str, str]
    sampling_period: float
    origin: Origin | None = None
    process_origin: Origin | None = None
    precision: Precision = "double"
    dialect: str = "codesys"
    alarms: Beside | None = None

    @property
    def interval(self) -> str:
        """TIME of the task."""
        return time_literal(self.sampling_period)

    @cached_property
    def units(self) -> tuple[Unit, ...]:
        """What it consists of, in the order in which one needs the other; the program last.

        Raises
        ------
        InputError
            A block cannot be printed, both have the same name or different types, functions or
            blocks of one, a wire does not fit, or a TIME cannot hold the sampling period.
        """
        dialect, precision = dialect_of(self.dialect), self.precision
        time_literal(self.sampling_period)  # refuses what no TIME can hold
        printed = [(self.controller, self.origin), (self.process, self.process_origin)]
        if self.alarms:
            printed.insert(0, (self.alarms.program, self.alarms.origin))
        named = [(each.name, f"the block {each.name}") for each, _ in printed]
        dialect.names.check_distinct(named)
        *beside, controller, process = (in_precision(each, precision) for each, _ in printed)
        used = (each.name for each in (*beside, controller, process))
        wording = StructuredText(dialect, precision, tuple(used))
        measured, moved, rest = wired(controller, process, self.wires, self.sampling_period)
        wiring = Wiring(measured, rest), Wiring(moved, rest)
        alarms = None
        if self.alarms:
            seen, _, still = wired(beside[0], process, self.alarms.wires, self.sampling_period)
            alarms = beside[0], Wiring(seen, still)
        program = loop_program(controller, process, wiring, wording, alarms)
        units: dict[str, tuple[Unit, Program]] = {}
        for each, origin in printed:
            for unit in function_blocks(each, dialect, precision, origin):
                # What both have stands there once.
                known, other = units.setdefault(unit.name.lower(), (unit, each))
                if _without_words(known) != _without_words(unit):
                    raise InputError(
                        f"test project, block {each.name}, {unit.kind} {unit.name}",
                        Finding("another one of that name"),
                        f"{known.kind} {known.name} as in block {other.name}",
                        "rename one of them",
                    )
        # One needs the other: types and functions come first.
        blocks = sorted(
            (unit for unit, _ in units.values()),
            key=lambda unit: unit.kind not in ("TYPE", "FUNCTION"),
        )
        head = self._head(program.name, dialect)
        return (*blocks, replace(program, head=head))

    def _head(self, name: str, dialect: Dialect) -> tuple[str, ...]:
        lines = [
            f"{name}: {self.controller.name} at work on the simulated {self.process.name}.",
            f"Printed by Clepsydra {__version__}.",
            *(self.origin.lines() if self.origin else ()),
            f"Call it in a cyclic task of {self.interval}; it starts at rest. A change of a "
            "setpoint or",
            "a disturbance here moves the plant as the simulation of Clepsydra does.",
            "For tests only: delete it and the simulated process before the plant is connected.",
        ]
        if not dialect.programs:
            lines.insert(-1, "It is a block, to be called from a cyclic interrupt such as OB30.")
        return tuple(lines)


def _without_words(unit: Unit) -> tuple[object, ...]:
    """Return what a unit is, whatever is said of it."""
    variables = [replace(e, comment="") for section in unit.sections for e in section.variables]
    return unit.kind, variables, unit.body, unit.result


def print_test_project(project: Project) -> str:
    """Print a test project as text.

    In the text of matiec the task is included: a CONFIGURATION with the names that OpenPLC
    wants. CODESYS and TwinCAT have tasks outside the text, and in TIA Portal the program is
    a function block for a cyclic interrupt.

    Raises
    ------
    InputError
        See `Project.units`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.process_program import process_program
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> text = print_test_project(Project(
    ...     controller.program(), process_program(plant.point, 1),
    ...     controller.input_wires | controller.output_wires, 1.0, dialect="matiec"))
    >>> [line for line in text.splitlines() if "TASK" in line]
    ['    TASK sampling(INTERVAL := T#1s, PRIORITY := 0);']
    """
    dialect = dialect_of(project.dialect)
    lines = [line for unit in project.units for line in (*unit_text(unit, dialect), "")]
    if dialect.configuration:
        program = project.units[-1].name
        lines += [
            f"CONFIGURATION {CONFIGURATION}",
            f"  RESOURCE {RESOURCE} ON PLC",
            f"    TASK {TASK}(INTERVAL := {project.interval}, PRIORITY := 0);",
            f"    PROGRAM instance_of_{program} WITH {TASK} : {program};",
            "  END_RESOURCE",
            "END_CONFIGURATION",
            "",
        ]
    return "\n".join(lines)


def wired(
    controller: Program, process: Program, wires: Mapping[str, str], sampling_period: float
) -> tuple[dict[str, str], dict[str, str], dict[str, float]]:
    """Return how two programs are wired to each other.

    Parameters
    ----------
    controller, process : Program
    wires : mapping
        Signal of the controller to the loop's signal, as `Controller.input_wires` and
        `Controller.output_wires` have it: "level_1.pv" to "level_1", "level_1.sp" to
        "level_1.setpoint", "pump_1.out" to "pump_1".
    sampling_period : float
        [s]

    Returns
    -------
    measured : dict
        Input of the controller to the output of the process that it reads.
    moved : dict
        Input of the process to the output of the controller that moves it.
    rest : dict
        Input of the controller that nothing moves to its value at the start.

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
    >>> wired(law, tank, wires, 1.0)[2]
    {'level_1.sp': 0.4}
    """
    shown = {signal.name: signal for signal in process.outputs}
    driven = {signal.name: signal for signal in process.inputs}
    known = shown | driven
    measured, moved, rest = {}, {}, {}
    # Where no alarm stands beside the tank what it would hold is forced by hand.
    fixed = {"mode": float(Mode.AUTOMATIC), "sensor": 1.0, INTERLOCK.name: 0.0}
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
    return measured, moved, rest


def _check(wire: str, known: Mapping[str, Signal], place: str, what: str) -> None:
    if wire not in known:
        raise InputError(
            f"test project, {place}", wire or Finding("no wire"),
            f"{what} of the process: {', '.join(known)}", "wire it as in the loop",
        )  # fmt: skip
