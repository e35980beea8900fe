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
    from clepsydra.process.reader import load_process
    from clepsydra.study.study import run_study

    if not folder.is_dir():
        raise InputError("--output", str(folder), "a folder that exists", "make the folder first")
    plant = load_process(process)
    report, data = (_target(folder / f"{plant.name}.{kind}") for kind in ("html", "parquet"))
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
        from clepsydra.cli.output import print_json

        print_json({**result.as_dict(), **written})
    else:
        for what, where in written.items():
            typer.echo(f"{what.capitalize()}: {where}")


def _target(path: Path) -> Path:
    from clepsydra.base.errors import InputError

    if path.is_dir():
        raise InputError("--output", str(path), "the name of a file", "move that folder away")
    return path
