"""``clepsydra export``: a controller or a process as code for the plant."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from clepsydra.cli.options import JsonOption
from clepsydra.cli.plant_options import (
    FailSafeOption,
    RateLimitOption,
    SensorDelayOption,
    SetpointRateOption,
)
from clepsydra.cli.subject import SubjectArgument, name_of

if TYPE_CHECKING:
    from clepsydra.controllers.plant_shell.settings import PlantShell
    from clepsydra.deploy.export import ExportedFiles
    from clepsydra.deploy.fmi.write import FmiVersion
    from clepsydra.deploy.printing.precision import Precision
    from clepsydra.process.process import Process
    from clepsydra.studies.file.request import StudyRequest
    from clepsydra.studies.result import StudyResult


class Target(Enum):
    """What is written."""

    st = "st"
    c = "c"
    fmu = "fmu"
    tuning = "tuning"


class DialectName(Enum):
    """Whose Structured Text."""

    codesys = "codesys"
    matiec = "matiec"
    scl = "scl"


class PrecisionName(Enum):
    """Of the numbers: LREAL and double, or REAL and float."""

    double = "double"
    single = "single"


class FmiName(Enum):
    """Of the FMU."""

    third = "3.0"
    second = "2.0"


def export(
    subject: SubjectArgument,
    target: Annotated[
        Target,
        typer.Option(
            "--to",
            help="st: IEC 61131-3 Structured Text with a test project and PLCopen XML; c: C99; "
            "fmu: a functional mock-up unit; tuning: PID settings in the vendors' forms and units.",
        ),
    ],
    controller: Annotated[
        str | None,
        typer.Option(
            "--controller",
            metavar="NAME",
            callback=name_of,
            help="As the study calls it, in quotation marks; with --to fmu it may be left out: "
            "then the process itself is exported.",
        ),
    ] = None,
    dialect: Annotated[
        DialectName | None,
        typer.Option(
            help="Of Structured Text: codesys (CODESYS, TwinCAT; if left out), matiec (OpenPLC, "
            "Beremiz) or scl (TIA Portal)."
        ),
    ] = None,
    precision: Annotated[
        PrecisionName | None,
        typer.Option(help="LREAL and double, as it is if left out, or REAL and float."),
    ] = None,
    fmi: Annotated[
        FmiName | None, typer.Option(help="Version of the FMU; 3.0 if left out.")
    ] = None,
    fail_safe: FailSafeOption = None,
    sensor_delay: SensorDelayOption = None,
    setpoint_rate: SetpointRateOption = None,
    rate_limit: RateLimitOption = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of a tuning; that of the study if left out.")
    ] = None,
    as_json: JsonOption = False,
    folder: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="FOLDER", help="Where the files are written."),
    ] = Path(),
) -> None:
    """Write a controller for the plant, printed from the program that was simulated."""
    from clepsydra.base.files import write_together
    from clepsydra.cli.output import make_folder, print_json
    from clepsydra.cli.plant_options import read_plant_shell
    from clepsydra.cli.subject import read_subject, study_of_one
    from clepsydra.studies.file.request import StudyRequest

    make_folder(folder)
    code = (Target.st, Target.c)
    _check_fits("--dialect", dialect, target in (Target.st,), "--to st")
    _check_fits("--precision", precision, target in code, "--to st or --to c")
    _check_fits("--fmi", fmi, target is Target.fmu, "--to fmu")
    plant = fail_safe or sensor_delay or setpoint_rate or rate_limit
    shelled = controller is not None and target is not Target.tuning
    _check_fits("plant options", plant, shelled, "a --controller that is exported as code or FMU")
    request = read_subject(subject, seed)
    process = request.process if isinstance(request, StudyRequest) else request
    settings = read_plant_shell(
        process,
        fail_safe=fail_safe,
        sensor_delay=sensor_delay,
        setpoint_rate=setpoint_rate,
        rate_limit=rate_limit,
    )
    version: FmiVersion = fmi.value if fmi else "3.0"
    if controller is None:
        found = _process(request, target, version)
    else:
        study = study_of_one(request, controller, seed, folder, quiet=as_json)
        spoken = dialect.value if dialect else "codesys"
        width: Precision = precision.value if precision else "double"
        found = _controller(study, controller, settings, target, spoken, width, version)
    written = write_together(folder, found.files)
    if as_json:
        print_json({"files": [str(path) for path in written], **found.facts})
        return
    from rich.console import Console

    for part in found.screen:
        Console(width=100).print(part)
    for path in written:
        typer.echo(f"Written: {path}")
    if found.next_step:
        typer.echo(f"Next: {found.next_step}")


def _check_fits(option: str, value: object, fits: bool, where: str) -> None:
    """Refuse an option that would have no effect."""
    from clepsydra.base.errors import InputError

    if value and not fits:
        shown = value.value if isinstance(value, Enum) else "given"
        raise InputError(option, shown, f"such an option with {where} only", "leave it out")


def _process(request: Process | StudyRequest, target: Target, version: FmiVersion) -> ExportedFiles:
    """Export the process itself, which is possible as an FMU only."""
    from clepsydra.base.errors import InputError
    from clepsydra.deploy.export import export_process_fmu
    from clepsydra.linear.analysis import analyse
    from clepsydra.studies.file.request import StudyRequest
    from clepsydra.studies.study import controller_names

    if target is not Target.fmu:
        raise InputError(
            "--controller", "none", f"the name of one: {'; '.join(controller_names(request))}",
            "name it in quotation marks",
        )  # fmt: skip
    analysis = request.analysis if isinstance(request, StudyRequest) else analyse(request)
    return export_process_fmu(analysis.operating_point, version=version)


def _controller(
    study: StudyResult,
    name: str,
    settings: PlantShell,
    target: Target,
    dialect: str,
    precision: Precision,
    version: FmiVersion,
) -> ExportedFiles:
    from clepsydra.deploy import export as exports
    from clepsydra.deploy.exportable import exportable

    chosen = next(c.controller for c in study.ranking if c.controller.name == name)
    point = study.analysis.operating_point
    if target is Target.tuning:
        return exports.export_tuning(chosen, point, study.scenario)
    ready = exportable(chosen, point, settings)
    if target is Target.st:
        return exports.export_structured_text(ready, dialect=dialect, precision=precision)
    if target is Target.c:
        return exports.export_c(ready, precision=precision)
    return exports.export_controller_fmu(ready, version=version)
