"""``clepsydra draw``: the picture of a process, with its loops if a controller is chosen."""

from __future__ import annotations

from pathlib import Path

import typer

from clepsydra.cli.options import SubjectArgument, controller_option
from clepsydra.cli.verb import verb


@verb(40)
def draw(
    subject: SubjectArgument,
    controller: str | None = controller_option(
        "Whose loops are drawn, as the study calls it, in quotation marks; none if left out."
    ),
    file: Path | None = typer.Option(
        None, "--output", "-o", metavar="FILE.svg", help="Where to write; NAME.svg if left out."
    ),
) -> None:
    """Draw a process with the values of its operating point; write SVG."""
    from clepsydra.cli.output import check_ending, output_file
    from clepsydra.cli.subject import study_of
    from clepsydra.interface.draw import draw as draw_plant
    from clepsydra.interface.subject import plant_of, read_subject

    if file is not None:
        check_ending(file, ".svg")
    request = read_subject(subject, None)
    plant, made = plant_of(request), None
    target = output_file(Path(f"{plant.file_stem}.svg") if file is None else file)
    if controller is not None:
        made = study_of(request, controller, None, target.parent, quiet=False)[controller]
    without = draw_plant(plant, target, made)
    for warning in plant.process.warnings:
        typer.echo(f"clepsydra: {warning}", err=True)
    if without is not None:
        # A plant that never rests has a picture all the same.
        typer.echo(f"clepsydra: drawn without values, since {without}", err=True)
    typer.echo(f"Drawing: {target}")
