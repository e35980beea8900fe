"""``clepsydra export``: a controller or a process as code for the plant."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import (
    FailSafeOption,
    JsonOption,
    RateLimitOption,
    SensorDelayOption,
    SetpointRateOption,
    SubjectArgument,
    controller_option,
    shell_options,
)
from clepsydra.cli.verb import verb
from clepsydra.interface.targets import TARGETS, targets_of


def _values(option: str) -> str:
    """Return what an option may be, as the help shows it."""
    return f"[{'|'.join(next(t.options[option] for t in TARGETS.values() if option in t.options))}]"


#: Targets of which the process itself can be exported.
_OF_PROCESS = " or ".join(f"--to {name}" for name, each in TARGETS.items() if each.process)
_Targets = Annotated[
    list[str],
    typer.Option(
        "--to",
        metavar=f"[{'|'.join(TARGETS)}]",
        help="; ".join(f"{name}: {each.words}" for name, each in TARGETS.items())
        + ". More than once for several.",
    ),
]


@verb(70)
def export(
    subject: SubjectArgument,
    targets: _Targets,
    controller: str | None = controller_option(
        f"As the study calls it, in quotation marks; with {_OF_PROCESS} it may be left out: "
        "then the process itself is exported."
    ),
    dialect: str | None = typer.Option(
        None,
        metavar=_values("dialect"),
        help="Of Structured Text: codesys (CODESYS, TwinCAT; if left out), matiec (OpenPLC, "
        "Beremiz) or scl (TIA Portal).",
    ),
    precision: str | None = typer.Option(
        None,
        metavar=_values("precision"),
        help="LREAL and double, as it is if left out, or REAL and float.",
    ),
    fmi: str | None = typer.Option(
        None, metavar=_values("fmi"), help="Version of the FMU; 3.0 if left out."
    ),
    fail_safe: FailSafeOption = None,
    sensor_delay: SensorDelayOption = None,
    setpoint_rate: SetpointRateOption = None,
    rate_limit: RateLimitOption = None,
    seed: int | None = typer.Option(
        None, min=0, help="Of a tuning; that of the study if left out."
    ),
    as_json: JsonOption = False,
    folder: Path = typer.Option(
        Path(), "--output", "-o", metavar="FOLDER", help="Where the files are written."
    ),
) -> None:
    """Write a controller for the plant, printed from the program that was simulated."""
    from clepsydra.cli.output import named_options, print_json, results_folder, show
    from clepsydra.cli.subject import study_of
    from clepsydra.interface.export import export as export_code
    from clepsydra.interface.shell import plant_shell
    from clepsydra.interface.study import names_of
    from clepsydra.interface.subject import plant_of, read_subject

    results_folder(folder)
    options = shell_options(fail_safe, sensor_delay, setpoint_rate, rate_limit)
    chosen = {"precision": precision, "dialect": dialect, "fmi": fmi}
    names = {f"export, {option}": f"--{option}" for option in ("to", *chosen)}
    with named_options("to", **names):  # refused before a controller is made
        targets_of(targets, chosen, shell=any(options.values()), process=controller is None)
    request = read_subject(subject, seed)
    plant = plant_of(request)
    with named_options(*options):
        plant_shell(plant, **options)
    made, scenario = None, None
    if controller is None:
        _check_process(subject, len(names_of(request)), targets)
    else:
        study = study_of(request, controller, seed, folder, quiet=as_json)
        made, scenario, plant = study[controller].controller, study.scenario, study.plant
    found = export_code(
        made,
        plant,
        folder,
        targets,
        precision=precision,
        dialect=dialect,
        fmi=fmi,
        scenario=scenario,
        **options,
    )
    if as_json:
        print_json({"files": [str(path) for path in found.files], **found.facts})
        return
    show(found)


def _check_process(subject: str, controllers: int, targets: list[str]) -> None:
    """Refuse to export the process itself where only controllers are exported."""
    from clepsydra.base.errors import Finding, InputError

    if any(TARGETS[target].process is None for target in targets):
        raise InputError(
            "--controller", Finding("none"), f"the name of one of {controllers}",
            f"name it in quotation marks; clepsydra study {subject} --all lists those that apply",
        )  # fmt: skip
