"""Errors of designs and laws, told with the line of the file that caused them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from clepsydra.base.errors import InputError
from clepsydra.process.table_reader import TableReader


@contextmanager
def errors_at(
    table: TableReader,
    places: Mapping[str, str] | None = None,
    but: tuple[type[InputError], ...] = (),
) -> Iterator[None]:
    """Give an `InputError` the place in a table that it is about.

    An error that has a place in the file keeps it. Else it is the place of the key or parameter
    with which the error's own place ends, or else of the table.

    Parameters
    ----------
    places : mapping, optional
        Parameter of a law to the place of the key that gave it.
    but : tuple of type
        Errors that keep their place, since they are about another file.
    """
    try:
        yield
    except but:
        raise
    except InputError as error:
        raise InputError(
            _place(error, table, places or {}), error.value, error.expected, error.remedy
        ) from None


def _place(error: InputError, table: TableReader, places: Mapping[str, str]) -> str:
    parts = error.place.split(", ")
    if error.place.startswith(f"{table.place().partition(', line ')[0]}, line "):
        return error.place
    for part in reversed(parts):
        if part in places:
            return places[part]
        if table.has(part):
            return table.place(part)
    return table.place()
