"""A proof on a terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from clepsydra.deploy.proof.finding import findings
from clepsydra.deploy.proof.row import ProofRow
from clepsydra.deploy.proof.words import next_step, notes, result_sentence

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.text import Text

    from clepsydra.deploy.proof.proof import Proof

_STYLES = {
    "fails": "bold red",
    "refused": "yellow",
    "diverges": "yellow",
    "reported": "dim",
}
_LEGEND = (
    "Largest difference as a share of the signal's range, in double precision from the engine: 0 "
    "is equal in every bit. ST single is compared with C single, and C single with the engine in "
    "double precision; the ranking changes where the number by which a study ranks does so by half "
    "a percent. Of FMUs for model exchange the derivatives are compared with those of CasADi."
)


#: Columns of a name that stands beside what is said of it, of the screen, and of its table.
_NAME, _WIDTH, _TABLE = 20, 80, 100


def proof_screen(proof: Proof, *, whole: bool = False) -> RenderableType:
    """Return a line for each controller and process and what to do next, for Rich.

    Parameters
    ----------
    proof : Proof
    whole : bool
        Whether the table of every target, the notes and the versions follow, in 100 columns.

    Examples
    --------
    >>> from rich.console import Console
    >>> from clepsydra.deploy.proof.proof import Proof
    >>> console = Console(width=100)
    >>> with console.capture() as shown:
    ...     console.print(proof_screen(Proof(())))
    >>> shown.get().startswith("Nothing was compared.")
    True
    """
    from rich.console import Group
    from rich.constrain import Constrain
    from rich.text import Text

    subjects = list(dict.fromkeys(row.subject for row in proof.rows))
    width = max((len(name) for name in subjects if len(name) <= _NAME), default=2)
    parts: list[RenderableType] = [Text(f"{result_sentence(proof)}\n", style="bold")]
    for name in subjects:
        found = findings(row for row in proof.rows if row.subject == name)
        said = [Text(words, style=_style(row)) for row, words in found]
        if name in proof.coverage and proof.coverage[name].still:
            said.append(Text(f"never moved: {', '.join(proof.coverage[name].still)}"))
        parts.append(_beside(name, width, Text("; ").join(said)))
    parts = [Constrain(Group(*parts), _WIDTH)]
    if whole:
        parts += [Text(), *_table(proof, subjects, width), *map(Text, notes(proof))]
        parts.append(Text(f"\n{'; '.join(proof.versions)}", style="dim"))
    parts.append(Constrain(Text(f"\nNext: {next_step(proof)}"), _WIDTH))
    return Group(*parts)


def _beside(name: str, width: int, text: Text) -> RenderableType:
    """Return a text beside a name, or below one that is longer than its column."""
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 2, 0, 0))
    grid.add_column(width=width, no_wrap=True)
    grid.add_column()
    if len(name) <= width:
        grid.add_row(Text(name), text)
        return grid
    grid.add_row("", text)
    return Group(Text(name), grid)


def _table(proof: Proof, subjects: list[str], width: int) -> Iterator[RenderableType]:
    """Yield the lines of the largest differences, a column for each target, and how to read them.

    They are no table of Rich, in which a long name would have to share its column's width.
    """
    from rich.text import Text

    heads = list(dict.fromkeys(_head(row) for row in proof.rows if row.program))
    if not heads:
        return
    tells_scores = any(row.scores for row in proof.rows)
    lines = []
    for name in subjects:
        found = {_head(row): row for row in proof.rows if row.subject == name}
        cells = [_cell(found[head]) if head in found else ("", "") for head in heads]
        if all(not row.program for row in found.values()):
            row = next(iter(found.values()))
            cells = [(row.verdict, _style(row)), *cells[1:]]
        lines.append((name, [*cells, *([_scores(found.values())] if tells_scores else [])]))
    heads += ["ranking\nsingle"] * tells_scores
    for place in range(2):
        lines.insert(place, ("", [(head.split("\n")[place], "bold") for head in heads]))
    columns = zip(*(cells for _, cells in lines), strict=True)
    widths = [max(len(text) for text, _ in column) for column in columns]
    width = max(min(width, _TABLE - sum(widths) - 2 * len(widths)), 2)
    for name, cells in lines:
        right = (Text(c[0].rjust(w), style=c[1]) for c, w in zip(cells, widths, strict=True))
        yield _beside(name, width, Text("  ").join(right))
    yield Text(f"\n{_LEGEND}\n", style="dim")


def _scores(rows: Iterable[ProofRow]) -> tuple[str, str]:
    """Return whether single precision changes the ranking of a loop."""
    for row in rows:
        if row.scores:
            return ("change", "yellow") if row.scores["is_change"] else ("same", "dim")
    return "", ""


def _head(row: ProofRow) -> str:
    """Return a narrow head: "ST\nmatiec", "FMU 3.0\nexchange", "C\nsingle"."""
    words = row.target.replace("Structured Text", "ST").replace(",", "").split()
    if row.precision == "single":
        words.append("single")
    *first, last = [*words, ""] if len(words) == 1 else words
    return "\n".join([" ".join(first), last])


def _style(row: ProofRow) -> str:
    if row.scores.get("is_change"):
        return "yellow"
    return _STYLES.get("fails" if not row.holds else row.verdict, "")


def _cell(row: ProofRow) -> tuple[str, str]:
    style = _style(row)
    if row.verdict in ("refused", "fails", "diverges"):
        return row.verdict, style
    if row.verdict == "differs" and row.largest in (0.0, math.inf):
        return "differs", style
    return "0" if row.differing == 0 else f"{row.largest:.1g}".replace("e-0", "e-"), style
