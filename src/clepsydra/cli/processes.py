"""``clepsydra processes``: what the catalogue holds."""

from __future__ import annotations

import typer

from clepsydra.cli.options import JsonOption


def processes(as_json: JsonOption = False) -> None:
    """List the processes of the catalogue with their sources and variants."""
    from clepsydra.interface.catalogue import catalogue

    entries = catalogue()
    if as_json:
        from clepsydra.cli.output import print_json

        print_json({"processes": [entry.as_dict() for entry in entries]})
        return
    for entry in entries:
        typer.echo(f"{entry.name}\n    {entry.title}\n    source: {entry.source}")
        for name, description in entry.variants.items():
            default = " (default)" if name in entry.default_variants else ""
            words = f": {description}" if description else ""
            typer.echo(f"    variant {entry.name}:{name}{default}{words}")
        typer.echo()
    typer.echo(
        "Study one with: clepsydra study NAME. Copy one with: clepsydra new MINE --from NAME"
    )
