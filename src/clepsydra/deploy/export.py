"""The files of an export: what each target gets, ready to be written together."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.base.errors import InputError
from clepsydra.controllers.controller import Controller
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.compiler import find_compiler
from clepsydra.deploy.exportable import Exportable, described, exportable_name
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.process import process_model
from clepsydra.deploy.fmi.write import FmiVersion, write_fmu
from clepsydra.deploy.plcopen.printer import print_plcopen_project
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.printing.identifiers import check_identifier
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.structured_text.dialect import dialect_of
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.deploy.structured_text.project import Project, print_test_project
from clepsydra.deploy.structured_text.time_literal import time_literal
from clepsydra.deploy.tagged import tagged_point
from clepsydra.deploy.vendor_tuning.translation import translate
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import substeps_for
from clepsydra.program.program import Program

if TYPE_CHECKING:
    from rich.console import RenderableType


@dataclass(frozen=True)
class ExportedFiles:
    """What an export consists of.

    Parameters
    ----------
    files : mapping
        Name to content.
    facts : mapping
        For JSON: name and digest of the program, and what else belongs to the target.
    next_step : str
        What the engineer does with them; empty where the screen ends with it.
    screen : tuple of renderable
        Tables for a terminal.

    Examples
    --------
    See `export_c`.
    """

    files: Mapping[str, bytes]
    facts: Mapping[str, Any]
    next_step: str
    screen: tuple[RenderableType, ...] = ()


def export_structured_text(
    ready: Exportable, *, dialect: str = "codesys", precision: Precision = "double"
) -> ExportedFiles:
    """Print a controller as a function block, and a project that runs it against the tank.

    Parameters
    ----------
    ready : Exportable
    dialect : {"codesys", "matiec", "scl"}
    precision : {"double", "single"}

    Returns
    -------
    ExportedFiles
        NAME.st (NAME.scl) with the function block, NAME_test.st with block, tank and the program
        that runs both, and but for scl NAME_test.xml, the same as PLCopen XML. A tank with a
        number that REAL cannot hold is left out.

    Raises
    ------
    InputError
        The target has no form for a name, a tag, a number or the sampling period.

    Examples
    --------
    See `export_c`.
    """
    name, ending = ready.program.name, "scl" if dialect == "scl" else "st"
    time_literal(ready.process.sampling_period)  # refuses what no task can hold
    words = dialect_of(dialect).all_words
    for signal, tag in ready.process.tags.items():
        place = f"{ready.process.address}, tag of {signal}"
        check_identifier(tag, place, f"Structured Text, {dialect}", words, ignore_case=True)
    block = print_structured_text(
        ready.program, origin=ready.origin, precision=precision, dialect=dialect
    )
    texts = {f"{name}.{ending}": block}
    next_step = f"docs/plc.md says how {name}.{ending} comes into the project of the PLC; "
    tank = process_program(tagged_point(ready.point), _substeps(ready.point))
    try:
        print_structured_text(tank, precision=precision, dialect=dialect)
    except InputError as refusal:
        next_step += f"there is no test project, since the tank cannot be printed: {refusal}"
    else:
        projects = _test_projects(ready, tank, dialect, precision)
        texts |= {f"{name}_test.{kind}": text for kind, text in projects.items()}
        next_step += f"run {name}_test.{ending} there first."
    # TIA Portal takes a text without a byte order mark for one of the machine's code page.
    encoding = "utf-8-sig" if dialect == "scl" else "utf-8"
    return ExportedFiles(
        {file: text.encode(encoding) for file, text in texts.items()},
        _facts(ready, precision=precision, dialect=dialect),
        next_step,
    )


def _test_projects(
    ready: Exportable, tank: Program, dialect: str, precision: Precision
) -> dict[str, str]:
    """Return the project that runs a controller against its tank, by the ending of its file."""

    wires, period = ready.wires, ready.process.sampling_period
    about = process_origin(ready.point)
    project = Project(ready.program, tank, wires, period, ready.origin, about, precision, dialect)
    if dialect == "scl":  # TIA Portal reads no PLCopen XML
        return {"scl": print_test_project(project)}
    return {"st": print_test_project(project), "xml": print_plcopen_project(project)}


def export_c(ready: Exportable, *, precision: Precision = "double") -> ExportedFiles:
    """Print a controller as C99: a header and a source.

    Parameters
    ----------
    ready : Exportable
    precision : {"double", "single"}

    Raises
    ------
    InputError
        C has no form for a name or a number.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.exportable import exportable
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> list(export_c(exportable(controller, plant.point)).files)
    ['quadruple_tank_pi_simc.h', 'quadruple_tank_pi_simc.c']
    """
    printed = print_c(ready.program, origin=ready.origin, precision=precision)
    name = ready.program.name
    return ExportedFiles(
        {
            printed.header_name: printed.header.encode(),
            printed.source_name: printed.source.encode(),
        },
        _facts(ready, precision=precision),
        f"compile {printed.source_name}; call {name}_initialise, {name}_default_parameters and "
        f"{name}_default_inputs once and {name}_step every "
        f"{ready.process.sampling_period:g} s.",
    )


def export_controller_fmu(ready: Exportable, *, version: FmiVersion = "3.0") -> ExportedFiles:
    """Build the FMU of a controller, for co-simulation.

    Parameters
    ----------
    ready : Exportable
    version : {"3.0", "2.0"}
        Of the Functional Mock-up Interface.

    Raises
    ------
    InputError
        There is no C compiler.

    Examples
    --------
    See `export_c`.
    """
    name = ready.program.name
    model = controller_model(ready.program_in_si, ready.origin)
    return ExportedFiles(
        {f"{name}.fmu": _fmu(model, version)},
        _facts(ready, fmi=version),
        f"import {name}.fmu with a communication step of {ready.process.sampling_period:g} s, "
        "which is its time_step; until sensors and modes are set too it stands at fail-safe.",
    )


def export_process_fmu(point: OperatingPoint, *, version: FmiVersion = "3.0") -> ExportedFiles:
    """Build the FMUs of a process: for co-simulation, and for model exchange without delays.

    Parameters
    ----------
    point : OperatingPoint
        Where it starts.
    version : {"3.0", "2.0"}

    Raises
    ------
    InputError
        There is no C compiler.

    Examples
    --------
    See `export_c`.
    """
    substeps, origin, point = _substeps(point), process_origin(point), tagged_point(point)
    model = process_model(point, substeps, origin)
    files = {f"{model.name}.fmu": _fmu(model, version)}
    if point.process.motion.delays:
        exchange = "Its transport delays have no form for model exchange."
    else:
        other = exchange_model(point, origin)
        files[f"{other.name}.fmu"] = _fmu(other, version)
        exchange = f"{other.name}.fmu is for model exchange, where the importer integrates."
    return ExportedFiles(
        files,
        {"name": model.name, "digest": digest(model.programs[0]), "fmi": version},
        f"import {model.name}.fmu with a communication step that is a multiple of "
        f"{model.step:g} s. {exchange}",
    )


def export_tuning(
    controller: Controller, point: OperatingPoint, scenario: Scenario
) -> ExportedFiles:
    """Translate the tuning of PID loops into the forms and units of the vendors' own blocks.

    Parameters
    ----------
    controller : Controller
        Without a shell.
    point : OperatingPoint
    scenario : Scenario
        In which each form is simulated.

    Raises
    ------
    InputError
        The controller has no PID loop.

    Examples
    --------
    See `clepsydra.deploy.vendor_tuning.translation.translate`.
    """
    found = translate(controller, point.process, scenario)
    name = exportable_name(point.process, controller)
    return ExportedFiles(
        {f"{name}_tuning.md": found.as_markdown().encode()},
        found.as_dict(),
        "",
        (found.table(),),
    )


def process_origin(point: OperatingPoint) -> Origin:
    """Return where the numbers of a printed process come from.

    Examples
    --------
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> process_origin(find_equilibrium(load_process("quadruple-tank"))).default_source
    'process file'
    """
    process = point.process
    return Origin(
        "The process", described(process), "", process.sampling_period, {}, "process file"
    )


def _substeps(point: OperatingPoint) -> int:
    return substeps_for(linearise(point))


def _fmu(model: FmuModel, version: FmiVersion) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.fmu"
        write_fmu(path, model, find_compiler(f"FMU of {model.name}"), version=version)
        return path.read_bytes()


def _facts(ready: Exportable, **chosen: str) -> dict[str, Any]:
    return {
        "name": ready.program.name,
        "digest": digest(ready.program),
        "controller": ready.controller.name,
        "process": ready.process.address,
        "sampling_period": ready.process.sampling_period,
        **chosen,
    }
