"""``clepsydra rig``: a process in real time, on the wires of a plant."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from clepsydra.cli.options import FailSafeOption, SubjectArgument, controller_option, named_values
from clepsydra.cli.verb import verb

if TYPE_CHECKING:
    from clepsydra.interface.controller import AnyController
    from clepsydra.interface.rig import RunningRig

#: How often the line of a rig is written anew [s].
_EVERY = 1.0


@verb(55)
def rig(
    subject: SubjectArgument,
    controller: str | None = controller_option(
        "Of the local panel, as the study calls it; PI controllers by SIMC if left out."
    ),
    speed: float = typer.Option(1.0, help="Times as fast as real time."),
    local: bool = typer.Option(
        False, "--local/--remote", help="Whether its local panel moves the plant at first."
    ),
    fail_safe: FailSafeOption = None,
    silence: str | None = typer.Option(
        None,
        metavar="TIME",
        help="How long a controller may be silent before outputs go to their fail-safe values; "
        "three sampling periods, at least 1 s.",
    ),
    script: Path | None = typer.Option(
        None, metavar="FILE.toml", help="Faults, setpoints and disturbances at their times."
    ),
    folder: Path | None = typer.Option(
        None,
        "--output",
        "-o",
        metavar="FOLDER",
        help="Of its history and of what it remembers; clepsydra-rig/NAME if left out.",
    ),
    keep: str | None = typer.Option(
        None, metavar="TIME|SIZE", help="What of the history is kept, as in '7 d' or '500 MB'; all."
    ),
    resume: bool = typer.Option(False, "--resume", help="Go on where it stood in that folder."),
    duration: str | None = typer.Option(
        None, metavar="TIME", help="End after so long of the plant's time; else by control-C."
    ),
    seed: int = typer.Option(1, min=0, help="Of the noise, which is off at first."),
) -> None:
    """Run a process in real time, and offer it to controllers on its wires."""
    from clepsydra.cli.output import named_options
    from clepsydra.cli.subject import study_of
    from clepsydra.interface.every_design import designed
    from clepsydra.interface.quantities import read_time
    from clepsydra.interface.rig import rig as rig_of
    from clepsydra.interface.subject import plant_of, read_subject

    request = read_subject(subject)
    made: AnyController | None = None
    if controller is not None:
        made = designed(request, controller)
        made = made or study_of(request, controller, None, folder, quiet=True)[controller]
    options = ("speed", "fail_safe", "silence", "script", "keep", "resume", "folder")
    names = {f"rig, {each}": f"--{each.replace('_', '-')}" for each in options}
    with named_options(*options, **names | {"rig, folder": "--output"}):
        remedy = "write as in --fail-safe pump_1='0 V'"
        running = rig_of(
            plant_of(request), made, speed=speed, local=local, silence=silence, script=script,
            fail_safe=named_values(fail_safe, "signal", "--fail-safe", remedy), folder=folder,
            keep=keep, resume=resume, seed=seed,
        )  # fmt: skip
        ends = None if duration is None else read_time("rig", "duration", duration)
        with running:
            _show(running, ends)


def _show(running: RunningRig, ends: float | None) -> None:
    """Show how a rig stands until it ends."""
    for line in running.opening:
        typer.echo(line)
    in_place = sys.stdout.isatty()
    try:
        while ends is None or running.elapsed < ends:
            for report in running.watch(_EVERY):
                typer.echo(("\r\033[K" if in_place else "") + str(report))
            if in_place:
                typer.echo(f"\r\033[K{running.standing}", nl=False)
    except KeyboardInterrupt:
        pass
    if in_place:
        typer.echo()
    typer.echo(f"Ended. {running.history.path} has every sample.")
