"""A proof on a terminal of 100 columns."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from clepsydra.deploy.proof.row import ProofRow
from clepsydra.deploy.proof.words import next_step, notes, result_sentence

if TYPE_CHECKING:
    from rich.console import RenderableType

    from clepsydra.deploy.proof.proof import Proof

_STYLES = {
    "differs": "bold red",
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


def proof_screen(proof: Proof) -> RenderableType:
    """Return a line for each controller and process, the notes and what to do next, for Rich.

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
    from rich import box
    from rich.console import Group
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    heads = list(dict.fromkeys(_head(row) for row in proof.rows if row.program))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    table.add_column("", overflow="fold", max_width=26)
    for head in heads:
        table.add_column(head, justify="right", no_wrap=True)
    tells_scores = any(row.scores for row in proof.rows)
    if tells_scores:
        table.add_column("ranking\nsingle", justify="right", no_wrap=True)
    for subject in dict.fromkeys(row.subject for row in proof.rows):
        found = {_head(row): row for row in proof.rows if row.subject == subject}
        texts = [_cell(found[head]) if head in found else ("", "") for head in heads]
        if all(not row.program for row in found.values()):
            refused = next(iter(found.values()))
            texts = [("refused", _STYLES["refused" if refused.holds else "fails"]), *texts[1:]]
        if tells_scores:
            texts.append(_scores(found.values()))
        table.add_row(Text(subject), *(Text(text, style=style) for text, style in texts))
    parts: list[RenderableType] = [Text(result_sentence(proof), style="bold")]
    if heads:
        parts += [table, Text(_LEGEND, style="dim"), Text()]
    parts += [Padding(Text(note), (0, 0, 0, 2)) for note in notes(proof, brief=True)]
    if proof.versions:
        parts.append(Text(f"\n{'; '.join(proof.versions)}", style="dim"))
    parts.append(Text(f"\nNext: {next_step(proof)}"))
    return Group(*parts)


def _scores(rows: Iterable[ProofRow]) -> tuple[str, str]:
    """Return whether single precision changes the ranking of a loop."""
    for row in rows:
        if row.scores:
            return ("change", "yellow") if row.scores["is_change"] else ("same", "dim")
    return "", ""


def _head(row: ProofRow) -> str:
    """Return a narrow head: "ST\\nmatiec", "C\\nsingle"."""
    words = row.target.replace("Structured Text", "ST").replace(",", "").split()
    if row.precision == "single":
        words.append("single")
    return "\n".join([words[0], " ".join(words[1:])])


def _cell(row: ProofRow) -> tuple[str, str]:
    style = _STYLES.get(row.verdict, "")
    if row.verdict == "refused" and not row.holds:
        style = _STYLES["fails"]
    if row.verdict in ("refused", "fails", "diverges"):
        return row.verdict, style
    if row.verdict == "differs" and row.largest in (0.0, math.inf):
        return "differs", style
    return "0" if row.differing == 0 else f"{row.largest:.0e}".replace("e-0", "e-"), style
