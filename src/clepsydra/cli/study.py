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
    from clepsydra.cli.output import check_folder, output_file, print_json
    from clepsydra.process.reader import load_process
    from clepsydra.study.study import run_study

    check_folder(folder)
    plant = load_process(process)
    report, data = (
        output_file(folder / f"{plant.file_stem}.{kind}") for kind in ("html", "parquet")
    )
    result = run_study(plant, seed=seed)
    if not as_json:
        from rich.console import Console

        from clepsydra.report.tables import ranking_table

        Console(width=100).print(ranking_table(result))

    from clepsydra.loop.parquet import write_parquet
    from clepsydra.report.html import write_report

    write_report(result, report)
    written = {"report": str(report)}
    if result.ranking:
        write_parquet([candidate.run for candidate in result.ranking], data)
        written["trajectories"] = str(data)
    if as_json:
        print_json({**result.as_dict(), **written})
    else:
        for what, where in written.items():
            typer.echo(f"{what.capitalize()}: {where}")
