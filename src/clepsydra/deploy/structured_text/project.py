"""A project that runs a controller against the simulated process, as text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from clepsydra import __version__
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.structured_text.dialect import Dialect, dialect_of
from clepsydra.deploy.structured_text.pou import Unit, unit_text
from clepsydra.deploy.structured_text.printer import function_blocks
from clepsydra.deploy.structured_text.simulated_plant import loop_program, wired
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

    Examples
    --------
    See `print_test_project`.
    """

    controller: Program
    process: Program
    wires: Mapping[str, str]
    sampling_period: float
    origin: Origin | None = None
    process_origin: Origin | None = None
    precision: Precision = "double"
    dialect: str = "codesys"

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
            A block cannot be printed, both have the same name, a wire does not fit, or a TIME
            cannot hold the sampling period.
        """
        dialect, precision = dialect_of(self.dialect), self.precision
        time_literal(self.sampling_period)  # refuses what no TIME can hold
        pair = (self.controller, self.process)
        named = [(each.name, f"the block {each.name}") for each in pair]
        dialect.names.check_distinct(named)
        controller, process = (in_precision(each, precision) for each in pair)
        wiring = wired(controller, process, self.wires, self.sampling_period)
        wording = StructuredText(dialect, precision, (controller.name, process.name))
        program = loop_program(controller, process, wiring, wording)
        units = [
            *function_blocks(self.controller, dialect, precision, self.origin),
            *function_blocks(self.process, dialect, precision, self.process_origin),
        ]
        # A function that both call stands there once.
        shared = ("TYPE", "FUNCTION")
        functions = {unit.name: unit for unit in units if unit.kind in shared}
        blocks = (unit for unit in units if unit.kind not in shared)
        head = self._head(program.name, dialect)
        return (*functions.values(), *blocks, replace(program, head=head))

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
