"""``clepsydra draw``: the picture of a process, as one SVG file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import ProcessArgument


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
    from clepsydra.base.files import whole_file
    from clepsydra.cli.output import check_ending, output_file
    from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
    from clepsydra.process.reader import load_process
    from clepsydra.report.drawing import process_drawing

    if file is not None:
        check_ending(file, ".svg")
    plant = load_process(process)
    target = output_file(Path(f"{plant.file_stem}.svg") if file is None else file)
    try:
        point = find_equilibrium(plant)
    except NoEquilibrium as error:
        # A plant that never rests has a picture all the same.
        point = None
        typer.echo(f"clepsydra: drawn without values, since {error}", err=True)
    picture = process_drawing(plant, point)
    with whole_file(target) as part:
        part.write_text(picture, encoding="utf-8")
    typer.echo(f"Drawing: {target}")
