"""``clepsydra analyse``: what the linear model says about a process."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import JsonOption, ProcessArgument
from clepsydra.cli.verb import verb


@verb(30)
def analyse(
    process: ProcessArgument,
    every: Annotated[
        bool, typer.Option("--all", help="Show every signal, pole, zero, gain and sentence.")
    ] = False,
    as_json: JsonOption = False,
    file: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE.html",
            help="Write a page with poles, Bode, Nyquist, step responses and relative gains.",
        ),
    ] = None,
) -> None:
    """Show operating point, poles, zeros, static gain, RGA and pairing of a process."""
    from clepsydra.cli.output import check_ending, output_file, print_json, show
    from clepsydra.interface.analyse import analyse as analysis_of
    from clepsydra.interface.plant import load

    if file is not None:
        check_ending(file, ".html", ".htm")
    analysis = analysis_of(load(process))
    if file is not None:
        analysis.report(output_file(file))
    if as_json:
        written = {} if file is None else {"page": str(file)}
        print_json({**analysis.as_dict(), **written})
        return
    show(analysis.shown(every=every))
    if file is not None:
        typer.echo(f"Page: {file}")
