"""``clepsydra analyse``: what the linear model says about a process."""

from __future__ import annotations

from pathlib import Path

import typer

from clepsydra.cli.options import JsonOption, ProcessArgument, all_option
from clepsydra.cli.verb import verb


@verb(30)
def analyse(
    process: ProcessArgument,
    every: bool = all_option("Show every signal, pole, zero, gain and sentence."),
    as_json: JsonOption = False,
    file: Path | None = typer.Option(
        None,
        "--output",
        "-o",
        metavar="FILE.html",
        help="Write a page with poles, Bode, Nyquist, step responses and relative gains.",
    ),
) -> None:
    """Show operating point, poles, zeros, static gain, RGA and pairing of a process."""
    from clepsydra.cli.output import check_ending, output_file, tell
    from clepsydra.interface.analyse import analyse as analysis_of
    from clepsydra.interface.plant import load

    if file is not None:
        check_ending(file, ".html", ".htm")
    analysis = analysis_of(load(process))
    if file is not None:
        analysis.report(output_file(file))
    tell(analysis, {} if file is None else {"page": file}, as_json=as_json, every=every)
