"""``clepsydra processes``: what the catalogue holds."""

from __future__ import annotations

import typer

from clepsydra.cli.options import JsonOption, all_option
from clepsydra.cli.verb import verb


@verb(50)
def processes(
    name: str | None = typer.Argument(
        None, metavar="[NAME]", help="One process, with source and variants."
    ),
    every: bool = all_option("Show sources and variants of every process."),
    as_json: JsonOption = False,
    schema: bool = typer.Option(
        False, "--schema", help="Print the JSON Schema of process files, for editors."
    ),
) -> None:
    """List the processes of the catalogue with their sources and variants."""
    if schema:
        from clepsydra.cli.output import print_json
        from clepsydra.interface.catalogue import schema_of_processes

        print_json(schema_of_processes())
        return
    from clepsydra.cli.output import print_json, show
    from clepsydra.interface.catalogue import catalogue

    entries = catalogue(name)
    if as_json:
        print_json({"processes": [entry.as_dict() for entry in entries]})
    else:
        show(entries.shown(every=every))
