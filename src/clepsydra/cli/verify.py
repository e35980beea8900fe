"""``clepsydra verify``: proof that what is exported runs what was simulated."""

from __future__ import annotations

import typer

from clepsydra.cli.options import (
    FailSafeOption,
    JsonOption,
    OutputOption,
    RateLimitOption,
    SensorDelayOption,
    SetpointRateOption,
    SubjectArgument,
    all_option,
    controller_option,
    shell_options,
)
from clepsydra.cli.verb import verb
from clepsydra.interface.targets import TARGETS

_PROVED = f"[{'|'.join(name for name, target in TARGETS.items() if target.runs)}]"


@verb(80)
def verify(
    subject: SubjectArgument,
    controller: str | None = controller_option("One controller; every one if left out."),
    to: list[str] | None = typer.Option(
        None,
        metavar=_PROVED,
        help="What is run, also repeated; all if left out.",
    ),
    scans: int = typer.Option(10_000, min=10_000, help="Random scans of each controller."),
    seed: int | None = typer.Option(
        None, min=0, help="Of the scans and the study; 1, or that of the study file."
    ),
    fail_safe: FailSafeOption = None,
    sensor_delay: SensorDelayOption = None,
    setpoint_rate: SetpointRateOption = None,
    rate_limit: RateLimitOption = None,
    every: bool = all_option("Show every target, with notes and versions."),
    as_json: JsonOption = False,
    folder: OutputOption = None,
) -> None:
    """Run every controller on every target, and compare it with the simulation.

    Exit status: 0 all within their bounds, 1 not, 130 interrupted; run it again to go on.
    """
    from clepsydra.cli.output import named_options, print_json, results_folder, show
    from clepsydra.cli.progress import shown_progress
    from clepsydra.cli.subject import study_of
    from clepsydra.interface.export import identifier_of
    from clepsydra.interface.shell import plant_shell
    from clepsydra.interface.subject import plant_of, read_subject
    from clepsydra.interface.verify import proved_targets, so_far
    from clepsydra.interface.verify import verify as prove

    place = results_folder(folder, as_json=as_json)
    targets = proved_targets(to or None)
    request = read_subject(subject, seed)
    options = shell_options(fail_safe, sensor_delay, setpoint_rate, rate_limit)
    with named_options(*options):
        plant_shell(plant_of(request), **options)  # refused before a controller is made
    stem = request.file_stem
    study = study_of(request, controller, seed, place, quiet=as_json)
    if controller is not None:
        stem = f"{stem}-{identifier_of(controller).replace('_', '-')}"
    chosen = [
        each.controller for each in study.ranking if controller in (None, each.controller.name)
    ]
    with shown_progress(so_far, quiet=as_json) as tell:
        proof = prove(
            chosen,
            study.plant,
            to=targets,
            scans=scans,
            seed=1 if seed is None else seed,
            scenario=study.scenario,
            folder=place,
            stem=stem,
            progress=tell,
            **options,
        )
    if as_json:
        print_json(proof.as_dict())
    else:
        show(proof.shown(every=every))
    if proof.interrupted:
        raise typer.Exit(130)
    if not proof.holds:
        raise typer.Exit(1)
