"""Arguments and options that several verbs share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ProcessArgument = Annotated[
    str,
    typer.Argument(
        metavar="PROCESS", help="A process of the catalogue, or the path of a process file."
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON document and nothing else.")
]
OutputOption = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FOLDER",
        help="Where files are written: here if left out, with --json nowhere.",
    ),
]
