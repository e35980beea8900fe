"""``clepsydra verify``: proof that what is exported runs what was simulated."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import JsonOption
from clepsydra.cli.plant_options import (
    FailSafeOption,
    RateLimitOption,
    SensorDelayOption,
    SetpointRateOption,
)
from clepsydra.cli.subject import SubjectArgument, name_of


def verify(
    subject: SubjectArgument,
    controller: Annotated[
        str | None,
        typer.Option(
            "--controller",
            metavar="NAME",
            callback=name_of,
            help="One controller; every one if left out.",
        ),
    ] = None,
    scans: Annotated[
        int, typer.Option(min=10_000, help="Random scans of each controller.")
    ] = 10_000,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Of the scans and the study; 1, or that of the study file."),
    ] = None,
    fail_safe: FailSafeOption = None,
    sensor_delay: SensorDelayOption = None,
    setpoint_rate: SetpointRateOption = None,
    rate_limit: RateLimitOption = None,
    as_json: JsonOption = False,
    folder: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="FOLDER", help="Where the proof is written."),
    ] = Path(),
) -> None:
    """Run every controller as C, Structured Text and FMU, and compare it with the simulation.

    Exit status: 0 all within their bounds, 1 not, 130 interrupted; run it again to go on.
    """
    from clepsydra.cli.output import make_folder, print_json
    from clepsydra.cli.plant_options import read_plant_shell
    from clepsydra.cli.progress import shown_progress
    from clepsydra.cli.subject import read_subject, study_of_one
    from clepsydra.deploy.printing.identifiers import identifier_of
    from clepsydra.deploy.proof.of_study import proof_items
    from clepsydra.deploy.proof.proof import prove
    from clepsydra.studies.file.request import StudyRequest
    from clepsydra.studies.study import run_study

    make_folder(folder)
    request = read_subject(subject, seed)
    settings = read_plant_shell(
        request.process if isinstance(request, StudyRequest) else request,
        fail_safe=fail_safe,
        sensor_delay=sensor_delay,
        setpoint_rate=setpoint_rate,
        rate_limit=rate_limit,
    )
    chosen, stem = 1 if seed is None else seed, request.file_stem
    if controller is None:
        with shown_progress(quiet=as_json) as tell:
            study = run_study(request, seed=chosen, progress=tell, tuning_folder=folder)
        items = proof_items(study, settings)
    else:
        study = study_of_one(request, controller, seed, folder, quiet=as_json)
        items = [
            item
            for item in proof_items(study, settings)
            if item.name == controller or item.kind == "process"
        ]
        stem = f"{stem}-{identifier_of(controller).replace('_', '-')}"
    with shown_progress(quiet=as_json) as tell:
        proof = prove(
            items, scans=scans, seed=chosen, progress=tell, folder=folder, stem=f"{stem}-proof"
        )
    if as_json:
        print_json(proof.as_dict())
    else:
        from rich.console import Console

        from clepsydra.deploy.proof.screen import proof_screen

        Console(width=100).print(proof_screen(proof))
    if proof.interrupted:
        raise typer.Exit(130)
    if not proof.holds:
        raise typer.Exit(1)
