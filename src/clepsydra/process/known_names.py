"""Names in a file that have to be among those that are known."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from clepsydra.base.arguments import require_known
from clepsydra.base.suggestion import suggestion
from clepsydra.process.table_reader import TableReader


def known_name(table: TableReader, key: str, name: str, known: Collection[str], words: str) -> str:
    """Return a name that was written at a key."""
    require_known(table.place(key), name, known, words)
    return name


def known_names(
    known: Sequence[str],
    table: TableReader,
    key: str,
    *,
    expected: str,
    remedy: str = "",
    each: str = "",
) -> tuple[str, ...]:
    """Read a list of names.

    Parameters
    ----------
    expected, remedy : str
        What the list is and how it is written: as a list of the first of those that are known
        where no remedy is given.
    each : str
        What each name is: one of those that are known where that is not said.
    """
    names = table.names(key, expected, remedy or f'write as in ["{known[0]}"]')
    for name in names:
        if name not in known:
            remedy = suggestion(name, known, f"choose from {', '.join(known)}")
            raise table.refused(key, name[:60], each or f"one of {', '.join(known)}", remedy)
    return names
