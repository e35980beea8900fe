"""The processes that Clepsydra brings along."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.base.suggestion import suggestion
from clepsydra.interface.shown import Answered
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


class Catalogue(Answered, tuple[CatalogueEntry, ...]):
    """Processes of the catalogue; printed, a table of them, or of one its source and variants."""

    __slots__ = ()

    def answer(self, *, every: bool = False) -> Section:
        """Return a table of them, or each whole: its source and its variants."""
        parts: list[Line | Table | Section] = []
        if every or len(self) == 1:
            parts += [_whole(entry) for entry in self]
        else:
            rows = tuple((each.name, each.title, str(len(each.variants) or "")) for each in self)
            parts.append(Table("", ("process", "what it is", "variants"), rows, names=2, kept=2))
            parts += [Line(""), Line("Sources and variants: --all, or the name of one."), Line("")]
        subject = self[0].name if len(self) == 1 else "NAME"
        parts += [
            Line(f"Next: clepsydra study {subject}", Mark.COMMAND),
            Line(f"      clepsydra new MINE --from {subject}", Mark.COMMAND),
        ]
        return Section("", tuple(parts))


def catalogue(name: str | None = None) -> Catalogue:
    """Return the processes of the catalogue, or the one of this name, without their equations.

    Printed, it is a table of them.

    Raises
    ------
    InputError
        No process has the name.

    Examples
    --------
    >>> [entry.name for entry in catalogue()][:2]
    ['averaging-tank', 'eight-tanks']
    """
    names = catalogue_names()
    if name is not None and name not in names:
        raise InputError(
            "processes", name, f"one of: {', '.join(names)}",
            suggestion(name, names, "choose one of them"),
        )  # fmt: skip
    entries = []
    for key in names if name is None else [name]:
        tables = tomllib.loads(catalogue_file(key).read_text(encoding="utf-8"))
        default = tables.get("default_variant", [])
        entries.append(
            CatalogueEntry(
                key,
                tables.get("title", key),
                tables.get("source", "not given"),
                {
                    variant: table.get("description", "")
                    for variant, table in tables.get("variants", {}).items()
                },
                (default,) if isinstance(default, str) else tuple(default),
            )
        )
    return Catalogue(entries)


def _whole(entry: CatalogueEntry) -> Section:
    parts: list[Line] = [Line(f"{entry.title}."), Line(f"Source: {entry.source}.")]
    for name, words in entry.variants.items():
        taken = " (taken where none is named)" if name in entry.default_variants else ""
        said = f": {words}" if words else ""
        parts.append(Line(f"{entry.name}:{name}{taken}{said}", Mark.POINT))
    return Section(entry.name, (*parts, Line("")))


def schema_of_studies() -> dict[str, Any]:
    """Return the JSON Schema of study files, for editors."""
    from clepsydra.studies.file.reader import study_schema

    return study_schema()


def schema_of_lessons() -> dict[str, Any]:
    """Return the JSON Schema of lesson files, for editors."""
    from clepsydra.laboratory.lessons.schema import lesson_schema

    return lesson_schema()


def schema_of_processes() -> dict[str, Any]:
    """Return the JSON Schema of process files, for editors."""
    from clepsydra.process.schema import process_schema

    return process_schema()
