"""The table of drags, and its place in the documentation."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks import machine
from benchmarks.live.drags import Drags, median_of
from benchmarks.page import PAGE, table, with_spread, write

LIVE_PAGE = PAGE.with_name("live-report.md")
MARKS = ("<!-- drags: begin -->", "<!-- drags: end -->")
_FACTS = ("Date", "Processor", "System", "Load before the start")


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine before anything is timed."""
    return [fact for fact in machine.description() if fact[0] in _FACTS]


def render(found: Sequence[Drags], described: Sequence[tuple[str, str]], rounds: int) -> str:
    """Return the section as Markdown."""
    rows = [
        [
            each.name,
            each.controller,
            f"{each.samples:,}",
            with_spread(each.worker, 1),
            with_spread(each.beside, 1),
            f"{each.size / 1e3:,.0f}",
        ]
        for each in found
    ]
    heads = ["process", "controller", "samples", "worker [ms]", "page [ms]", "report [kB]"]
    return "\n\n".join(
        [
            table(["", ""], described),
            f"Medians of {rounds} moves of a slider each, smallest and largest in brackets; the "
            f"median of both together over these reports is {median_of(found):.1f} ms.",
            table(heads, rows),
        ]
    )


def write_page(text: str) -> None:
    """Put the section on its page."""
    write(text, LIVE_PAGE, MARKS)
