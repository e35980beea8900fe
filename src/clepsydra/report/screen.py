"""Sections on a terminal: as wide as it is, and no name broken within a word."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from clepsydra.base.section import Line, Mark, Picture, Section, Table

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
    from rich.table import Table as RichTable

#: A long name takes more lines rather than more of the width than this.
_NAME = 30
_BACKSLASH, _INDENT = " \\", " " * 8
#: What of a command stays in one line: an option with its value, a quoted name, a word.
_PIECES = re.compile(r'--\S+ (?:"[^"]*"|[^-\s]\S*)|(?:"[^"]*"|\S)+')
_STYLES = {Mark.ANSWER: "bold", Mark.WATCH: "yellow"}


class Screen:
    """A section as Rich shows it on a terminal of any width.

    Examples
    --------
    >>> import io
    >>> from rich.console import Console
    >>> console = Console(width=20, file=io.StringIO(), record=True)
    >>> table = Table("", ("level", "settles", "noise"), (("tank_1", "34.0 s", "3.3 %"),), kept=1)
    >>> console.print(Screen(Section("", (table,))))
    >>> [line.strip() for line in console.export_text().splitlines() if "level" in line]
    ['level   settles']
    """

    def __init__(self, section: Section) -> None:
        self.section = section

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield what is shown in the width that there is."""
        from rich.text import Text

        if self.section.title:
            yield Text(self.section.title, style="bold")
        beside: list[RenderableType] = []
        width, lost = options.max_width, 0
        for part in self.section.parts:
            if isinstance(part, Picture):
                continue
            if isinstance(part, Table):
                shown, lost = _fitting(part, width)
                beside.append(shown)
                continue
            yield from _placed(beside)
            beside = []
            if isinstance(part, Line) and part.narrow and lost:
                columns = f"{lost} column{'s' if lost > 1 else ''}"
                part = replace(part, text=part.narrow.format(columns))
            yield Screen(part) if isinstance(part, Section) else _line(part, width)
        yield from _placed(beside)


def _placed(tables: list[RenderableType]) -> list[RenderableType]:
    """Return tables that follow each other, side by side where there is room."""
    from rich.columns import Columns

    return [Columns(tables, padding=(0, 4))] if len(tables) > 1 else tables


def _line(line: Line, width: int) -> RenderableType:
    from rich.table import Table as RichTable
    from rich.text import Text

    style = _STYLES.get(line.mark, "")
    if line.mark in (Mark.PLAIN, Mark.ANSWER, Mark.NEXT):
        return Text(line.text, style=style)
    if line.mark is Mark.COMMAND:
        return Text(_continued(line.text, width))
    if line.mark is Mark.FILE:  # a path that is broken is none
        return Text(line.text, no_wrap=True, overflow="ignore")
    hanging = RichTable.grid(padding=(0, 2))
    hanging.add_column(width=2, justify="right")
    hanging.add_column()
    hanging.add_row(Text(line.mark.value, style=style), Text(line.text, style=style))
    return hanging


def _continued(command: str, width: int) -> str:
    """Return a command, on several lines that can be copied where it is too long for one."""
    if len(command) <= width:
        return command
    begun = len(command) - len(command.lstrip())
    first, *pieces = _PIECES.findall(command)
    lines = [" " * begun + first]
    for piece in pieces:
        if len(lines[-1]) + len(piece) + 1 > width - len(_BACKSLASH):
            lines.append(_INDENT + piece)
        else:
            lines[-1] += f" {piece}"
    return f"{_BACKSLASH}\n".join(lines)


def _fitting(table: Table, width: int) -> tuple[RenderableType, int]:
    """Return a table as there is room for it, and how many columns on its right have none."""
    from rich.console import Group

    columns = len(table.head)
    if table.kept:
        while columns > table.kept and _narrowest(_columns(table, 0, columns)) > width:
            columns -= 1
        shown = [_columns(table, 0, columns)]
    else:
        shown = _pieces(table, width)
    found = [_rich(each, breaks=_narrowest(each) > width) for each in shown]
    return Group(*found), len(table.head) - columns


def _pieces(table: Table, width: int) -> list[Table]:
    """Return the columns for which there is no room below the others, with the names again.

    A table stays whole where that would not do, since one of its columns is too wide alone.
    """
    names, found = table.names, list[Table]()
    begun = names
    for end in range(names + 1, len(table.head) + 1):
        if _narrowest(_columns(table, begun, end)) > width:
            if end == begun + 1:
                return [table]
            found.append(_columns(table, begun, end - 1))
            begun = end - 1
    last = _columns(table, begun, len(table.head))
    return [*found, last] if _narrowest(last) <= width else [table]


def _columns(table: Table, begun: int, end: int) -> Table:
    """Return a table with its names and some of its columns."""

    def cut(row: tuple[str, ...]) -> tuple[str, ...]:
        return (*row[: min(table.names, end)], *row[max(begun, table.names) : end])

    more = table.title and begun > table.names
    title = f"{table.title}, further columns" if more else table.title
    return replace(table, title=title, head=cut(table.head), rows=tuple(map(cut, table.rows)))


def _narrowest(table: Table) -> int:
    """Return how wide a table is with its names broken where they may be."""
    widths = [
        _name_width(cells)
        if place < table.names
        else max(len(line) for cell in cells for line in cell.split("\n"))
        for place, cells in enumerate(zip(table.head, *table.rows, strict=True))
    ]
    # Below a title columns are three apart, with one on each side, else two.
    return sum(widths) + (3 * len(widths) - 1 if table.title else 2 * len(widths))


def _name_width(cells: Sequence[str]) -> int:
    """Return how wide names are that are broken between words only."""
    longest_word = max(len(word) for cell in cells for word in ("", *cell.split()))
    return max(min(max(map(len, cells)), _NAME), longest_word)


def _rich(table: Table, *, breaks: bool) -> RichTable:
    """Return a table; what has no room breaks between words, so that nothing is lost."""
    from rich import box
    from rich.table import Table as RichTable
    from rich.text import Text

    found = RichTable(
        title=Text(table.title, style="bold") if table.title else None,
        title_justify="left",
        box=box.SIMPLE_HEAD if table.title else None,
        pad_edge=False,
        padding=(0, 1) if table.title else (0, 2, 0, 0),
    )
    for place, head in enumerate(table.head):
        named = place < table.names
        cells = [head, *(row[place] for row in table.rows)]
        settings: dict[str, Any] = {"min_width": _name_width(cells)} if named else {}
        no_wrap = max(map(len, cells)) <= _NAME if named else not breaks
        found.add_column(
            Text(head), justify="left" if named else "right", no_wrap=no_wrap, **settings
        )
    for row in table.rows:
        found.add_row(*[Text(cell) for cell in row])
    return found
