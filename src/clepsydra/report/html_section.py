"""Sections as HTML: what is the user's is escaped, what is folded is filled when it is opened."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from clepsydra.base.section import Line, Mark, Picture, Section, Table

if TYPE_CHECKING:
    from markupsafe import Markup

_LISTED = (Mark.POINT, Mark.REFUSED)
_CLASSES = {Mark.ANSWER: "answer", Mark.WATCH: "watch"}


def html(section: Section, depth: int = 2, *, scripted: bool = True) -> Markup:
    """Return a section as HTML, its title as a heading of this depth or above what it folds.

    Parameters
    ----------
    scripted : bool
        Whether a script fills what is folded when it is opened; else it is there from the start.

    Examples
    --------
    >>> print(html(Section("A < B", (Line("Robust."), Table("", ("loop", "K"), (("1", "3"),))))))
    <h2>A &lt; B</h2>
    <p>Robust.</p>
    <div class="wide"><table>
    <thead><tr><th scope="col">loop</th><th scope="col">K</th></tr></thead>
    <tbody>
    <tr><th scope="row">1</th><td>3</td></tr>
    </tbody></table></div>
    """
    from markupsafe import Markup, escape

    parts: list[str] = []
    inner = depth if section.folded else depth + 1
    for listed, group in groupby(section.parts, _is_listed):
        if listed:
            points = (f"<li>{escape(part.text)}</li>" for part in group)  # type: ignore[union-attr]
            parts.append(f"<ul>{''.join(points)}</ul>")
        else:
            parts += (_part(part, inner, scripted) for part in group)
    body = "\n".join(part for part in parts if part)
    if not section.title:
        return Markup(body)
    title = escape(section.title)
    if not section.folded:
        return Markup(f"<h{depth}>{title}</h{depth}>\n{body}")
    content = f"<template>{body}</template>" if scripted else body
    return Markup(f"<details><summary>{title}</summary>{content}</details>")


def _is_listed(part: Line | Table | Picture | Section) -> bool:
    return isinstance(part, Line) and part.mark in _LISTED


def _part(part: Line | Table | Picture | Section, depth: int, scripted: bool) -> str:
    from markupsafe import escape

    if isinstance(part, Section):
        return html(part, depth, scripted=scripted)
    if isinstance(part, Table):
        return _table(part)
    if isinstance(part, Picture):
        caption = f"<figcaption>{escape(part.words)}</figcaption>" if part.words else ""
        return f'<figure class="picture">{part.svg}{caption}</figure>'
    if not part.text:
        return ""
    if part.mark is Mark.COMMAND:
        return f"<pre>{escape(part.text)}</pre>"
    kind = f' class="{name}"' if (name := _CLASSES.get(part.mark)) else ""
    return f"<p{kind}>{escape(part.text)}</p>"


def _table(table: Table) -> str:
    from markupsafe import escape

    title = f"<caption>{escape(table.title)}</caption>" if table.title else ""
    head = ""
    if any(table.head):
        cells = (
            f'<th scope="col"{_kind(place, table.names)}>{escape(cell)}</th>'
            if cell
            else "<td></td>"
            for place, cell in enumerate(table.head)
        )
        head = f"\n<thead><tr>{''.join(cells)}</tr></thead>"
    rows = "\n".join(f"<tr>{_cells(row, table.names)}</tr>" for row in table.rows)
    return f'<div class="wide"><table>{title}{head}\n<tbody>\n{rows}\n</tbody></table></div>'


def _cells(row: Sequence[str], names: int) -> str:
    from markupsafe import escape

    first, *others = row
    found = [f'<th scope="row">{escape(first)}</th>']
    for place, cell in enumerate(others, start=1):
        found.append(f"<td{_kind(place, names)}>{escape(cell)}</td>")
    return "".join(found)


def _kind(place: int, names: int) -> str:
    return ' class="words"' if 0 < place < names else ""
