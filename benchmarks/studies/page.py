"""The table of studies and installations, and its place in the documentation."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from benchmarks import machine
from benchmarks.measure import Spread
from benchmarks.page import PAGE, table, with_spread, write
from benchmarks.studies.row import Row
from benchmarks.studies.trees import Tree

MARKS = ("<!-- studies: begin -->", "<!-- studies: end -->")
_FACTS = ("Date", "Processor", "Memory", "System", "Load before the start")
#: Variables that decide how linear algebra is computed.
_LINEAR_ALGEBRA = ("OPENBLAS_", "OMP_")


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine before anything is timed."""
    said = [f"{k}={v}" for k, v in sorted(os.environ.items()) if k.startswith(_LINEAR_ALGEBRA)]
    known = [fact for fact in machine.description() if fact[0] in _FACTS]
    return [*known, ("Linear algebra", ", ".join(said) or "as installed")]


def render(
    rows: Sequence[Row],
    described: Sequence[tuple[str, str]],
    after: Tree,
    before: Tree | None,
    rounds: str,
    notes: Sequence[str] = (),
) -> str:
    """Return the section as Markdown."""
    sides = (
        f"After is commit {after.commit}, before is commit {before.commit}."
        if before
        else f"After is commit {after.commit}. No earlier commit was measured beside it, so the "
        "columns before and ratio are empty."
    )
    return "\n\n".join(
        [
            table(["", ""], described),
            f"{sides} Medians ({rounds}), smallest and largest in brackets; ratios are taken "
            "within each round.",
            table(
                ["work", "before", "after", "ratio", "wanted", "met"],
                [
                    [
                        row.work, _shown(row.before, row.digits), _shown(row.after, row.digits),
                        _shown(row.ratio, 2), str(row.wanted or ""), row.verdict(),
                    ]
                    for row in rows
                ],
            ),
            *notes,
        ]
    )  # fmt: skip


def _shown(spread: Spread | None, digits: int) -> str:
    if spread is None:
        return ""
    if spread.low == spread.high:
        return f"{spread.median:,.{digits}f}"
    return with_spread(spread, digits)


def write_page(text: str, page: Path = PAGE) -> None:
    """Put the section between its marks; everything else on the page stays."""
    write(text, page, MARKS)
