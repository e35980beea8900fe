"""``clepsydra hil``: hardware in the loop."""

from __future__ import annotations

from pathlib import Path

import typer

from clepsydra.cli.options import JsonOption, SubjectArgument, all_option, controller_option
from clepsydra.cli.verb import verb


@verb(47)
def hil(
    subject: SubjectArgument,
    controller: str | None = controller_option(
        "As the study calls it, in quotation marks; PI controllers by SIMC if left out."
    ),
    plc: str = typer.Option(
        "st,c",
        metavar="NAME,NAME",
        help="What runs it: st, its Structured Text by matiec; c, its C by a compiler.",
    ),
    wires: str = typer.Option(
        "modbus,opc-ua", metavar="NAME,NAME", help="What lies between it and the plant."
    ),
    precision: str = typer.Option("double", help="Of what is exported: double or single."),
    encoding: str = typer.Option(
        "counts-27648", help="Of values in registers of Modbus, as of clepsydra rig."
    ),
    speed: float | None = typer.Option(
        None, help="Times as fast as real time; the fastest that meets its deadlines if left out."
    ),
    every: bool = all_option("Show every case in words."),
    as_json: JsonOption = False,
    folder: Path | None = typer.Option(
        None,
        "--output",
        "-o",
        metavar="FOLDER",
        help="Where the histories of its rigs stay; nowhere if left out.",
    ),
) -> None:
    """Run an exported controller in soft PLCs on the wires of its plant, in all cases."""
    from clepsydra.cli.output import named_options, tell
    from clepsydra.cli.subject import controller_of
    from clepsydra.interface.hil import run_hil
    from clepsydra.interface.subject import plant_of, read_subject

    request = read_subject(subject)
    made = None
    if controller is not None:
        made = controller_of(request, controller, folder, quiet=as_json)
    names = {f"hil, {each}": f"--{each}" for each in ("wires", "precision", "speed", "encoding")}
    with named_options(
        **names, **{"hil, plcs": "--plc", "rig, speed": "--speed", "rig, encoding": "--encoding"}
    ):
        found = run_hil(
            plant_of(request),
            made,
            plcs=_listed(plc),
            wires=_listed(wires),
            precision=precision,
            encoding=encoding,
            speed=speed,
            folder=folder,
            progress=None if as_json else _say,
        )
    tell(found, {}, as_json=as_json, every=every)
    if not found.holds:
        raise typer.Exit(1)


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _say(words: str) -> None:
    typer.echo(f"… {words}", err=True)
