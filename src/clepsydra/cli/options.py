"""Arguments and options that several verbs share."""

from __future__ import annotations

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
