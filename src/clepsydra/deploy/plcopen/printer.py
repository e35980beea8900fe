"""PLCopen XML of a step program, and of a controller with the simulated process beside it."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.deploy.plcopen.document import Task, document, flavour_of
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.library import function_blocks
from clepsydra.deploy.structured_text.project import CONFIGURATION, RESOURCE, TASK, make_project
from clepsydra.program.program import Program


def print_plcopen(
    program: Program,
    *,
    origin: Origin | None = None,
    precision: Precision = "double",
    dialect: str = "codesys",
) -> str:
    """Print a step program as PLCopen XML (TC6): the function block of `print_structured_text`.

    Parameters
    ----------
    program : Program
        Without fused operations.
    origin : Origin, optional
    precision : {"double", "single"}
    dialect : {"codesys", "matiec"}
        For CODESYS and TwinCAT 3, or for the editors of OpenPLC and Beremiz.

    Raises
    ------
    InputError
        What `print_structured_text` refuses, or a dialect whose editor reads no PLCopen XML.

    References
    ----------
    PLCopen Technical Committee 6, XML Formats for IEC 61131-3, version 2.01.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> "y := x + x;" in print_plcopen(program)
    True
    """
    flavour, spoken = flavour_of(dialect), dialect_of(dialect)
    units = function_blocks(program, spoken, precision, origin)
    return document(program.name, units, spoken, flavour, None)


def print_plcopen_project(
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
    """Print the test project of `print_test_project` as PLCopen XML.

    Parameters
    ----------
    controller, process, wires, sampling_period, origin, process_origin, precision
        See `clepsydra.deploy.structured_text.project.print_test_project`.
    dialect : {"codesys", "matiec"}
        The task is part of the document for the editors of OpenPLC and Beremiz; in CODESYS and
        TwinCAT it is made in the device tree.

    Raises
    ------
    InputError
        What `print_test_project` refuses, or a dialect whose editor reads no PLCopen XML.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.process_program import process_program
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> text = print_plcopen_project(
    ...     controller.program(), process_program(plant.point, 1),
    ...     controller.input_wires | controller.output_wires, 1.0, dialect="matiec")
    >>> 'interval="T#1s"' in text, text.count('pouType="program"')
    (True, 1)
    """
    flavour, spoken = flavour_of(dialect), dialect_of(dialect)
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
    task = Task(CONFIGURATION, RESOURCE, TASK, project.interval, project.program)
    return document(project.program, project.units, spoken, flavour, task)
