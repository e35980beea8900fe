"""Sections as Markdown."""

from __future__ import annotations

import re

from clepsydra.base.section import Line, Mark, Section, Table

_LINES = {
    Mark.PLAIN: "{}",
    Mark.ANSWER: "**{}**",
    Mark.POINT: "- {}",
    Mark.WATCH: "- ⚠ {}",
    Mark.REFUSED: "- {}",
    Mark.COMMAND: "`{}`",
    Mark.NEXT: "{}",
    Mark.FILE: "- {}",
}


def markdown(section: Section, depth: int = 2) -> str:
    """Return a section as Markdown, its title as a heading of this depth.

    Examples
    --------
    >>> table = Table("", ("loop", "K"), (("level_1 by pump_1", "3.00 V/V"),))
    >>> print(markdown(Section("Quadruple tank", (Line("Use PI, SIMC.", Mark.ANSWER), table))))
    ## Quadruple tank
    <BLANKLINE>
    **Use PI, SIMC.**
    <BLANKLINE>
    | loop | K |
    | --- | ---: |
    | level_1 by pump_1 | 3.00 V/V |
    """
    parts = [f"{'#' * depth} {_escaped(section.title)}"] if section.title else []
    for part in section.parts:
        if isinstance(part, Section):
            parts.append(markdown(part, depth + 1))
        elif isinstance(part, Table):
            parts.append(_table(part, depth + 1))
        elif isinstance(part, Line) and part.text:
            parts.append(_line(part))
    return "\n\n".join(parts)


def _line(line: Line) -> str:
    text = line.text.strip()
    return _LINES[line.mark].format(text if line.mark is Mark.COMMAND else _escaped(text))


def _table(table: Table, depth: int) -> str:
    rule = ["---" if place < table.names else "---:" for place in range(len(table.head))]
    rows = [f"| {' | '.join(map(_escaped, row))} |" for row in (table.head, *table.rows)]
    titled = [f"{'#' * depth} {_escaped(table.title)}\n"] if table.title else []
    return "\n".join([*titled, rows[0], f"| {' | '.join(rule)} |", *rows[1:]])


def _escaped(text: str) -> str:
    """Return text whose signs mean nothing to Markdown."""
    return re.sub(r"[\\`*\[\]>|]|<(?! )", r"\\\g<0>", text)
