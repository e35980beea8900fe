"""The processes that Clepsydra brings along."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from clepsydra.process.catalogue_names import catalogue_file, catalogue_names


@dataclass(frozen=True)
class CatalogueEntry:
    """A process of the catalogue.

    Parameters
    ----------
    name : str
        What `cl.load` takes.
    title, source : str
    variants : mapping
        Variant to what it is; "name:variant" loads it.
    default_variants : tuple of str
        Those that count where none is asked for.
    """

    name: str
    title: str
    source: str
    variants: Mapping[str, str]
    default_variants: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return it for JSON."""
        return {**asdict(self), "default_variants": list(self.default_variants)}


def catalogue() -> tuple[CatalogueEntry, ...]:
    """Return the processes of the catalogue, read without their equations.

    Examples
    --------
    >>> [entry.name for entry in catalogue()][:2]
    ['averaging-tank', 'eight-tanks']
    """
    entries = []
    for name in catalogue_names():
        tables = tomllib.loads(catalogue_file(name).read_text(encoding="utf-8"))
        default = tables.get("default_variant", [])
        entries.append(
            CatalogueEntry(
                name,
                tables.get("title", name),
                tables.get("source", "not given"),
                {
                    variant: table.get("description", "")
                    for variant, table in tables.get("variants", {}).items()
                },
                (default,) if isinstance(default, str) else tuple(default),
            )
        )
    return tuple(entries)
