"""References of a document to its own equations, tables and figures that point elsewhere."""

from __future__ import annotations

from collections.abc import Mapping

from clepsydra.papers.document import Found
from clepsydra.papers.printed_table import PrintedTable


def wrong_references(printed: PrintedTable, right: Mapping[tuple[str, str], str]) -> Found:
    """Return a misprint for each reference of a document that points elsewhere.

    Parameters
    ----------
    printed : PrintedTable
        Of the document; a reference is its line "reference: WORDS".
    right : mapping
        Place, and the words around the reference, to the number of what they speak of.
    """
    for (place, words), number in right.items():
        line = printed[place, f"reference: {words}"]
        yield line.stated(number, number == line.text)
