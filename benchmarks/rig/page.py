"""The tables of a rig's periods, and their place in the documentation."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version

from benchmarks import machine
from benchmarks.page import PAGE, table, write
from benchmarks.rig.lateness import Punctuality, RigTimes
from clepsydra.rig.plant_process import raise_priority

RIG_PAGE = PAGE.with_name("rig.md")
MARKS = ("<!-- periods: begin -->", "<!-- periods: end -->")
_FACTS = ("Date", "Processor", "System", "Load before the start")
_PACKAGES = ("asyncua", "pymodbus", "numpy")
_WANTED = 0.999
_HEADS = (
    "loop", "periods", "within 5 ms", "median [ms]", "99 % [ms]", "99.9 % [ms]", "latest [ms]",
)  # fmt: skip


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine before anything is timed."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    told = [fact for fact in machine.description() if fact[0] in _FACTS]
    return [*told, ("Packages", packages), ("Priority of both loops", _priority())]


def _priority() -> str:
    """Return what a plant gets here."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_raised).result()


def _raised() -> str:
    raise_priority()
    if os.sched_getscheduler(0) == os.SCHED_FIFO:
        return "real time"
    return f"nice {os.nice(0)}"


def render(found: Sequence[RigTimes], described: Sequence[tuple[str, str]], seconds: float) -> str:
    """Return the section as Markdown."""
    rows = []
    for each in found:
        rows.append(_row(f"rig: {each.plant.words}, {each.tags:,} tags", each.rig))
        rows.append(_row("bare loop beside it", each.bare))
    notes = [
        f"- {each.plant.words}: {'; '.join(each.clients)}; "
        f"{each.missed or 'no'} samples are missing in the history; load at the end "
        f"{each.load:.1f}."
        for each in found
    ]
    met = found[0].rig.in_time >= _WANTED
    words = "is met" if met else "is **not met** here"
    return "\n\n".join(
        [
            table(["", ""], described),
            f"{seconds:,.0f} s each. Of 99.9 % of the periods of 20 ms within 5 ms: it {words}.",
            table(_HEADS, rows),
            "What the Modbus master, the second Modbus client and the OPC UA subscriber got:",
            "\n".join(notes),
        ]
    )


def _row(words: str, found: Punctuality) -> list[str]:
    late = (f"{1e3 * found.quantile(share):.2f}" for share in (0.5, 0.99, 0.999, 1.0))
    return [words, f"{len(found.lateness):,}", f"{100 * found.in_time:.2f} %", *late]


def write_page(text: str) -> None:
    """Put the section on its page."""
    write(text, RIG_PAGE, MARKS)
