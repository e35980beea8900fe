"""``clepsydra draw``: the picture of a process, as one SVG file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import ProcessArgument
from clepsydra.cli.verb import verb


@verb(40)
def draw(
    process: ProcessArgument,
    file: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE.svg", help="Where to write; NAME.svg if left out."
        ),
    ] = None,
) -> None:
    """Draw a process with the values of its operating point; write SVG."""
    from clepsydra.cli.output import check_ending, output_file
    from clepsydra.interface.plant import load

    if file is not None:
        check_ending(file, ".svg")
    plant = load(process)
    target = output_file(Path(f"{plant.file_stem}.svg") if file is None else file)
    without = plant.draw(target)
    if without is not None:
        # A plant that never rests has a picture all the same.
        typer.echo(f"clepsydra: drawn without values, since {without}", err=True)
    typer.echo(f"Drawing: {target}")
