"""``clepsydra study``: every controller that applies, designed, simulated, scored and ranked."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clepsydra.cli.options import JsonOption, ProcessArgument


def study(
    process: ProcessArgument,
    as_json: JsonOption = False,
    folder: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="FOLDER", help="Where report and data are written."),
    ] = Path(),
    seed: Annotated[int, typer.Option(min=0, help="Seed of the measurement noise.")] = 1,
) -> None:
    """Design, simulate, score and rank controllers for a process; write report and data."""
    from clepsydra.base.errors import InputError
    from clepsydra.study.study import run_study

    if not folder.is_dir():
        raise InputError("--output", str(folder), "a folder that exists", "make the folder first")
    result = run_study(process, seed=seed)
    report = folder / f"{result.process.name}.html"
    data = folder / f"{result.process.name}.parquet"
    if not as_json:
        from rich.console import Console

        from clepsydra.report.tables import ranking_table

        Console(width=100).print(ranking_table(result))

    from clepsydra.loop.parquet import write_parquet
    from clepsydra.report.html import write_report

    write_report(result, report)
    write_parquet([candidate.run for candidate in result.ranking], data)
    if as_json:
        from clepsydra.cli.output import print_json

        print_json({**result.as_dict(), "report": str(report), "trajectories": str(data)})
    else:
        typer.echo(f"Report: {report}\nTrajectories: {data}")
