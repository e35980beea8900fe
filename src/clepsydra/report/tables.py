"""Tables for a terminal of 100 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.linear.analysis import Analysis
from clepsydra.report.analysis_tables import Grid, analysis_grids, operating_point_grid
from clepsydra.report.score_tables import (
    is_recommended,
    ranking_columns,
    ranking_note,
    ranking_rows,
)
from clepsydra.studies.result import StudyResult

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table


#: Controllers whose warnings stand in full.
_IN_FULL = 3


def ranking_table(result: StudyResult) -> RenderableType:
    """Return the verdict, the ranking with its reasons, and what to do next, for Rich.

    Parameters
    ----------
    result : StudyResult

    Returns
    -------
    rich.console.RenderableType
        At most 100 columns wide on a console of that width.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> import io
    >>> from rich.console import Console
    >>> console = Console(width=100, record=True, file=io.StringIO())
    >>> console.print(ranking_table(result))
    >>> console.export_text().strip().startswith(result.verdict[:40])
    True
    """
    from rich import box
    from rich.console import Group
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("", justify="right")
    table.add_column("controller", overflow="fold", max_width=24)
    table.add_column("standing", max_width=8)
    for column in ranking_columns(result):
        title = column.title.replace(" ", "\n")
        table.add_column(f"{title}\n{column.unit}", justify="right", no_wrap=True)
    rows = ranking_rows(result)
    for row in rows:
        style = "bold" if row.rank == 1 and is_recommended(result) else ""
        texts = (str(row.rank), row.controller, row.standing, *row.cells)
        table.add_row(*[Text(text, style=style) for text in texts])
    parts: list[RenderableType] = [Text(result.verdict, style="bold"), table]
    parts.append(Padding(Text(ranking_note(result), style="dim"), (0, 0, 1, 0)))
    parts += [hanging(f"{row.rank}  {row.controller}: {row.reason}") for row in rows]
    parts += [hanging(f"!  {warning}", "yellow") for warning in _warnings(result)]
    for name, reason in result.not_applicable:
        parts.append(hanging(f"–  {name} does not apply: {reason}"))
    parts.append(Text(f"\nNext: {_next_step(result)}"))
    return Group(*parts)


def _warnings(result: StudyResult) -> list[str]:
    """Return the warnings of the best three, and how many the others have."""
    words = [
        f"{candidate.controller.title}: {warning}"
        for candidate in result.ranking[:_IN_FULL]
        for warning in candidate.warnings
    ]
    others = [c for c in result.ranking[_IN_FULL:] if c.warnings]
    if others:
        count = sum(len(candidate.warnings) for candidate in others)
        names = ", ".join(f"{c.rank} ({len(c.warnings)})" for c in others)
        words.append(f"{count} more in the report, of the controllers ranked {names}.")
    return words


def analysis_table(analysis: Analysis) -> RenderableType:
    """Return an operating point and what the linear model says about it, for Rich.

    Parameters
    ----------
    analysis : Analysis

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis = cl.load("quadruple-tank").analysis
    >>> import io
    >>> from rich.console import Console
    >>> console = Console(width=100, record=True, file=io.StringIO())
    >>> console.print(analysis_table(analysis))
    >>> "Relative gains" in console.export_text()
    True
    """
    from rich.columns import Columns
    from rich.console import Group
    from rich.text import Text

    point = analysis.operating_point
    grids = [operating_point_grid(point), *analysis_grids(analysis)]
    parts: list[RenderableType] = [
        Text(f"{point.process.title} ({point.process.name})", style="bold"),
        Columns([grid_table(grid) for grid in grids], padding=(0, 4)),
    ]
    parts += [hanging(f"•  {sentence}") for sentence in analysis.words]
    parts += [hanging(f"!  {warning}", "yellow") for warning in point.warnings]
    address = point.process.address
    parts.append(Text(f"\nNext: design and compare controllers with 'clepsydra study {address}'."))
    return Group(*parts)


def _next_step(result: StudyResult) -> str:
    if not result.ranking:
        return "no controller applies; the reasons above say what the process lacks."
    if not is_recommended(result):
        return (
            "no controller can be recommended; open the report, see what the warnings above are "
            "about, and change the process or its sampling period."
        )
    return (
        f"open the report and read the page of {result.ranking[0].controller.title}: its "
        "parameters, pictures and warnings."
    )


def grid_table(grid: Grid) -> Table:
    """Return a table for Rich.

    Examples
    --------
    >>> grid_table(Grid("Scenario", ("what", "size"), (("load", "+2"),))).row_count
    1
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=Text(grid.title, style="bold"),
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    for place, head in enumerate(grid.head):
        table.add_column(Text(head), justify="right" if place else "left")
    for row in grid.rows:
        table.add_row(*[Text(cell) for cell in row])
    return table


def hanging(sentence: str, style: str = "") -> Table:
    """Return a sentence whose further lines start under its first word.

    Examples
    --------
    >>> len(hanging("!  pump_1 stood at its limit").columns)
    2
    """
    from rich.table import Table
    from rich.text import Text

    mark, _, words = sentence.partition("  ")
    line = Table.grid(padding=(0, 2))
    line.add_column(width=2, justify="right")
    line.add_column()
    line.add_row(Text(mark, style=style), Text(words, style=style))
    return line
