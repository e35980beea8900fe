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
    from clepsydra.interface.plant import Plant
    from clepsydra.interface.subject import StudyRequest


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
    from clepsydra.cli.output import make_folder, named_options, print_json, show
    from clepsydra.cli.plant_options import shell_options
    from clepsydra.cli.subject import study_of_one
    from clepsydra.interface.export import export as export_code
    from clepsydra.interface.shell import plant_shell
    from clepsydra.interface.subject import plant_of, read_subject

    make_folder(folder)
    code = (Target.st, Target.c)
    _check_fits("--dialect", dialect, target in (Target.st,), "--to st")
    _check_fits("--precision", precision, target in code, "--to st or --to c")
    _check_fits("--fmi", fmi, target is Target.fmu, "--to fmu")
    options = shell_options(
        fail_safe=fail_safe,
        sensor_delay=sensor_delay,
        setpoint_rate=setpoint_rate,
        rate_limit=rate_limit,
    )
    shelled = controller is not None and target is not Target.tuning
    _check_fits(
        "plant options",
        any(options.values()),
        shelled,
        "a --controller that is exported as code or FMU",
    )
    request = read_subject(subject, seed)
    plant = plant_of(request)
    with named_options(*options):
        plant_shell(plant, **options)  # refused before a controller is made
    chosen, scenario = None, None
    if controller is None:
        _check_process(request, target)
    else:
        study = study_of_one(request, controller, seed, folder, quiet=as_json)
        chosen, scenario, plant = study[controller].controller, study.scenario, study.plant
    found = export_code(
        chosen,
        plant,
        folder,
        target.value,
        dialect=dialect.value if dialect else "codesys",
        precision=precision.value if precision else "double",
        fmi=fmi.value if fmi else "3.0",
        scenario=scenario,
        **options,
    )
    if as_json:
        print_json({"files": [str(path) for path in found.files], **found.facts})
        return
    if found.screen:
        show(found)
    for line in found.lines:
        typer.echo(line)


def _check_fits(option: str, value: object, fits: bool, where: str) -> None:
    """Refuse an option that would have no effect."""
    from clepsydra.base.errors import InputError

    if value and not fits:
        shown = value.value if isinstance(value, Enum) else "given"
        raise InputError(option, shown, f"such an option with {where} only", "leave it out")


def _check_process(request: Plant | StudyRequest, target: Target) -> None:
    """Refuse to export the process itself as anything else than an FMU."""
    from clepsydra.base.errors import InputError
    from clepsydra.interface.study import names_of

    if target is not Target.fmu:
        raise InputError(
            "--controller", "none", f"the name of one: {'; '.join(names_of(request))}",
            "name it in quotation marks",
        )  # fmt: skip
