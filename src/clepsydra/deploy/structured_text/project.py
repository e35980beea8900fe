"""A project that runs a controller against the simulated process, as text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import Dialect, dialect_of
from clepsydra.deploy.structured_text.library import function_blocks
from clepsydra.deploy.structured_text.loop_program import make_loop_program
from clepsydra.deploy.structured_text.pou import Unit
from clepsydra.deploy.structured_text.pou_text import unit_text
from clepsydra.program.program import Program

#: Names that the runtime of OpenPLC looks for in what its compiler makes.
CONFIGURATION, RESOURCE, TASK = "Config0", "Res0", "sampling"


@dataclass(frozen=True)
class Project:
    """The units of a test project, in the order in which one needs the other.

    Parameters
    ----------
    units : tuple of Unit
        The blocks of the controller, the process, and the program that runs both.
    interval : str
        TIME of the task.

    Examples
    --------
    >>> Project((Unit("PROGRAM", "law_test", (), (), ()),), "T#1s").program
    'law_test'
    """

    units: tuple[Unit, ...]
    interval: str

    @property
    def program(self) -> str:
        """Name of the program that the task runs."""
        return self.units[-1].name


def make_project(
    controller: Program,
    process: Program,
    wires: Mapping[str, str],
    sampling_period: float,
    dialect: Dialect,
    *,
    precision: Precision,
    origin: Origin | None,
    process_origin: Origin | None,
) -> Project:
    """Return the units of a test project; see `print_test_project`."""
    program = make_loop_program(
        controller, process, wires, sampling_period, dialect, precision, origin
    )
    units = [
        *function_blocks(controller, dialect, precision, origin),
        *function_blocks(process, dialect, precision, process_origin),
    ]
    # A function that both call stands there once.
    functions = {unit.name: unit for unit in units if unit.kind == "FUNCTION"}
    blocks = [unit for unit in units if unit.kind != "FUNCTION"]
    return Project((*functions.values(), *blocks, program.unit), program.interval)


def print_test_project(
    controller: Program,
    process: Program,
    wires: Mapping[str, str],
    sampling_period: float,
    *,
    origin: Origin | None = None,
    process_origin: Origin | None = None,
    precision: Precision = "double",
    dialect: str = "codesys",
) -> str:
    """Print a controller, a process, and a program that runs one against the other.

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
        In the text of matiec the task is included: a CONFIGURATION with the names that OpenPLC
        wants. CODESYS and TwinCAT have tasks outside the text, and in TIA Portal the program is
        a function block for a cyclic interrupt.

    Raises
    ------
    InputError
        A block cannot be printed, both have the same name, a wire does not fit, or a TIME cannot
        hold the sampling period.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.process_program import process_program
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> text = print_test_project(
    ...     controller.program(), process_program(plant.point, 1),
    ...     controller.input_wires | controller.output_wires, 1.0, dialect="matiec")
    >>> [line for line in text.splitlines() if "TASK" in line]
    ['    TASK sampling(INTERVAL := T#1s, PRIORITY := 0);']
    """
    spoken = dialect_of(dialect)
    project = make_project(
        controller,
        process,
        wires,
        sampling_period,
        spoken,
        precision=precision,
        origin=origin,
        process_origin=process_origin,
    )
    lines: list[str] = []
    for unit in project.units:
        lines += [*unit_text(unit, spoken), ""]
    if spoken.configuration:
        lines += [
            f"CONFIGURATION {CONFIGURATION}",
            f"  RESOURCE {RESOURCE} ON PLC",
            f"    TASK {TASK}(INTERVAL := {project.interval}, PRIORITY := 0);",
            f"    PROGRAM instance_of_{project.program} WITH {TASK} : {project.program};",
            "  END_RESOURCE",
            "END_CONFIGURATION",
            "",
        ]
    return "\n".join(lines)
