"""``clepsydra processes``: what the catalogue holds."""

from __future__ import annotations

import tomllib
from typing import Any

import typer

from clepsydra.cli.options import JsonOption


def processes(as_json: JsonOption = False) -> None:
    """List the processes of the catalogue with their sources and variants."""
    entries = _catalogue()
    if as_json:
        from clepsydra.cli.output import print_json

        print_json({"processes": entries})
        return
    for entry in entries:
        typer.echo(f"{entry['name']}\n    {entry['title']}\n    source: {entry['source']}")
        for name, description in entry["variants"].items():
            default = " (default)" if name in entry["default_variants"] else ""
            words = f": {description}" if description else ""
            typer.echo(f"    variant {entry['name']}:{name}{default}{words}")
        typer.echo()
    typer.echo(
        "Study one with: clepsydra study NAME. Copy one with: clepsydra new MINE --from NAME"
    )


def _catalogue() -> list[dict[str, Any]]:
    """Return name, title, source and variants of each process, read without its equations."""
    from clepsydra.process.catalogue_names import catalogue_file, catalogue_names

    entries = []
    for name in catalogue_names():
        tables = tomllib.loads(catalogue_file(name).read_text(encoding="utf-8"))
        default = tables.get("default_variant", [])
        entries.append(
            {
                "name": name,
                "title": tables.get("title", name),
                "source": tables.get("source", "not given"),
                "variants": {
                    variant: table.get("description", "")
                    for variant, table in tables.get("variants", {}).items()
                },
                "default_variants": [default] if isinstance(default, str) else list(default),
            }
        )
    return entries
