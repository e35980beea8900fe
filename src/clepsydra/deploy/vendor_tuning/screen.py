"""A translation of tunings as tables for a terminal of 100 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.deploy.vendor_tuning.words import (
    check_words,
    difference_texts,
    footnotes,
    loop_words,
    refused_words,
)

if TYPE_CHECKING:
    from rich.console import RenderableType

    from clepsydra.deploy.vendor_tuning.translation import Translation


def tuning_screen(translation: Translation) -> RenderableType:
    """Return a table a loop, what the blocks do otherwise below it, and what to do next.

    Examples
    --------
    >>> import io
    >>> from rich.console import Console
    >>> import clepsydra as cl
    >>> from clepsydra.deploy.vendor_tuning.translation import translate
    >>> controller = cl.design.simc(cl.load("quadruple-tank"))
    >>> console = Console(width=100, record=True, file=io.StringIO())
    >>> console.print(translate(controller, "quadruple-tank").table())
    >>> "TI = 0.53387 min" in console.export_text()
    True
    """
    from rich import box
    from rich.console import Group
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    title = f"{translation.controller} on {translation.process}, for vendors' own PID blocks"
    parts: list[RenderableType] = [Text(title, style="bold")]
    notes, marks = footnotes(translation.rows)
    for tuning in translation.tunings:
        parts.append(Padding(Text(loop_words(tuning)), (1, 0, 0, 0)))
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
        table.add_column("block", max_width=26, overflow="fold")
        table.add_column("settings", overflow="fold")
        table.add_column("by the\nnumbers", justify="right", no_wrap=True)
        table.add_column("by the\nblock", justify="right", no_wrap=True)
        table.add_column("see", max_width=8, overflow="fold")
        for row, seen in zip(translation.rows, marks, strict=True):
            if row.tuning.loop != tuning.loop:
                continue
            cell = Text(", ".join(setting.words for setting in row.filled.settings))
            if row.filled.choices:
                said = ", ".join(f"{name}: {value}" for name, value in row.filled.choices)
                cell.append(f"\n{said}", style="dim")
            table.add_row(Text(row.block.title), cell, *difference_texts(row), seen)
        parts.append(table)
    for mark, words in (
        *((str(number), words) for number, words in enumerate(notes, start=1)),
        *(("–", words) for words in refused_words(translation)),
    ):
        parts.append(_hanging(mark, words))
    parts.append(Padding(Text(check_words(translation), style="dim"), (1, 0, 0, 0)))
    parts.append(
        Text("\nNext: enter the numbers; docs/vendor-tuning.md gives each block's scaling, equation"
             " and source.")
    )  # fmt: skip
    return Group(*parts)


def _hanging(mark: str, words: str) -> RenderableType:
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 1))
    grid.add_column(width=3, no_wrap=True)
    grid.add_column(overflow="fold")
    grid.add_row(Text(mark), Text(words))
    return grid
