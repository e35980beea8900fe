"""Text of a lesson for people: paragraphs, which a page shows as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from clepsydra.process import told
from clepsydra.process.declared import OWN, part
from clepsydra.process.table_reader import TableReader


def line(words: str, *, default: str | None = None) -> Any:
    """Return the field of one line of text."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> str:
        return table.text(key, "one line of text", f'write as in {key} = "…"', default=default)

    return part(read, required=(OWN,) if default is None else (), **told.text(words))


def paragraphs(words: str) -> Any:
    """Return the field of a text whose paragraphs have empty lines between them."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...]:
        return paragraphs_of(table, key, table.raw(key)) if table.has(key) else ()

    return part(read, **told.text(words))


def texts(words: str) -> Any:
    """Return the field of a list of texts."""

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[str, ...]:
        written = table.raw(key) if table.has(key) else []
        if not isinstance(written, list):
            raise table.wrong(key, "a list of texts", f'write as in {key} = ["…", "…"]')
        return tuple(" ".join(paragraphs_of(table, key, each)) for each in written)

    return part(read, description=words, type="array", items={"type": "string"})


def paragraphs_of(table: TableReader, key: str, written: object) -> tuple[str, ...]:
    """Return the paragraphs of a text, each in one line.

    Raises
    ------
    InputError
        It is no text, or has characters in it that cannot be seen.
    """
    if not isinstance(written, str) or not written.replace("\n", "").isprintable():
        shown = written if isinstance(written, str) else str(written)
        raise table.refused(
            key, ascii(shown[:40]), "text that can be printed", f'write as in {key} = "…"'
        )
    parts = (" ".join(each.split()) for each in written.split("\n\n"))
    return tuple(each for each in parts if each)
