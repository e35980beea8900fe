"""An audit in a screen: counts of each document, and on request every row not as printed."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.papers.audit import Audit
from clepsydra.papers.row import COUNTED
from clepsydra.papers.row_words import printed_words, value_words

#: Letters of a cell of the rows.
_LETTERS = 30


def audit_answer(result: Audit, *, every: bool = False) -> Section:
    """Return what an audit found.

    Parameters
    ----------
    result : Audit
    every : bool
        Whether the rows that are not as printed follow.

    Examples
    --------
    >>> audit_answer(Audit(())).parts[0].text.startswith("Of 0 printed numbers")
    True
    """
    parts: list[Line | Table | Section] = [Line(result.summary, Mark.ANSWER), Line("")]
    parts.append(_counts(result))
    listed = {
        document.document.key: tuple(
            (row.place, row.name, printed_words(row), value_words(row.computed), row.verdict)
            for row in document.rows
            if not row.is_as_printed
        )
        for document in result.documents
    }
    head = ("place", "what", "printed", "computed", "verdict")
    if every:
        for key, rows in listed.items():
            cells = tuple(tuple(_short(cell) for cell in row) for row in rows)
            parts.append(Table(f"{key}: what is not as printed", head, cells, names=5))
    elif count := sum(map(len, listed.values())):
        parts += [Line(""), Line(f"{count} rows that are not as printed: --all, or on the page.")]
    return Section("", tuple(parts))


def _counts(result: Audit) -> Table:
    rows = []
    for each in result.documents:
        numbers = [each.counts[verdict] for verdict in COUNTED]
        total = len(each.rows)
        numbers += total - sum(numbers), total
        rows.append((each.document.key, *map(str, numbers)))
    heads = tuple(verdict.replace(" ", "\n") for verdict in COUNTED)
    return Table("", ("document", *heads, "not\ncounted", "rows"), tuple(rows), kept=2)


def _short(text: str) -> str:
    return text if len(text) <= _LETTERS else f"{text[: _LETTERS - 1]}…"
