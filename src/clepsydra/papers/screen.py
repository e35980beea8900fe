"""An audit on a terminal: counts a document, and every row that is not as printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.papers.audit import Audit
from clepsydra.papers.row import COUNTED
from clepsydra.papers.row_words import printed_words, value_words

if TYPE_CHECKING:
    from rich.console import RenderableType


def audit_screen(result: Audit) -> RenderableType:
    """Return what an audit found, within 100 columns.

    Examples
    --------
    >>> from rich.console import Console
    >>> console = Console(width=100)
    >>> with console.capture() as shown:
    ...     console.print(audit_screen(Audit(())))
    >>> shown.get().startswith("Of 0 printed numbers")
    True
    """
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    counts = Table(box=None, padding=(0, 1), header_style="bold")
    counts.add_column("Document")
    for head in (*COUNTED, "not counted", "rows"):
        counts.add_column(head, justify="right")
    for document in result.documents:
        numbers = [document.counts[verdict] for verdict in COUNTED]
        rows = len(document.rows)
        numbers += rows - sum(numbers), rows
        counts.add_row(document.document.key, *map(str, numbers))
    parts: list[RenderableType] = [Text(result.summary, style="bold"), Text(), counts]
    for document in result.documents:
        notable = [row for row in document.rows if not row.is_as_printed]
        if not notable:
            continue
        table = Table(
            box=None, padding=(0, 1), header_style="bold", title_justify="left",
            title=f"\n{document.document.key}: what is not as printed", title_style="bold",
        )  # fmt: skip
        for head, most in (("Place", 14), ("What", 32), ("Printed", 16), ("Computed", 16)):
            table.add_column(head, max_width=most)
        table.add_column("Verdict", no_wrap=True)
        for row in notable:
            cells = (row.place, row.name, printed_words(row), value_words(row.computed))
            table.add_row(*(Text(cell) for cell in (*cells, row.verdict)))
        parts.append(table)
    return Group(*parts)
