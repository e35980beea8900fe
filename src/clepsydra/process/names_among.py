"""A list of names in a process file, each of which must be known."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.suggestion import suggestion
from clepsydra.process.table_reader import TableReader


def names_among(
    known: Sequence[str],
    table: TableReader,
    key: str,
    *,
    expected: str,
    remedy: str,
    each: str,
) -> tuple[str, ...]:
    """Read a list of names.

    Parameters
    ----------
    known : sequence of str
    table : TableReader
    key : str
    expected, remedy : str
        What the list is and how it is written.
    each : str
        What each name is.

    Raises
    ------
    InputError
        It is no list of names, a name stands twice, or one is unknown.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"controlled = ['level']", "plant.toml"), (), None)
    >>> names_among(
    ...     ["level", "strength"], table, "controlled", expected="a list of sensors",
    ...     remedy="write one", each="the name of a sensor")
    ('level',)
    """
    names = table.names(key, expected, remedy)
    for name in names:
        if name not in known:
            raise table.refused(
                key, name[:60], each, suggestion(name, known, f"choose from {', '.join(known)}")
            )
    return names
