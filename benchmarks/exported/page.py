"""The tables of exported code, and their places in the documentation."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from pathlib import Path

from benchmarks import machine
from benchmarks.exported.built import compiler_family, compiler_version
from benchmarks.exported.families import LINES_BEFORE
from benchmarks.exported.times import ExportedTimes
from benchmarks.page import PAGE, table, with_spread, write

SIZES_PAGE = PAGE.with_name("exported-code.md")
MARKS = ("<!-- exported code: begin -->", "<!-- exported code: end -->")
COMPILER = "C compiler"
CONTROLLER = "controller"
LINES = "lines of Structured Text"
BEFORE, OWN, SHARE = "before", "own block", "of before"
LIBRARY = "library, once for all exports"
OPERATIONS = "operations a scan"
STATE, PARAMETERS = "state [B]", "parameters [B]"
INPUTS, OUTPUTS = "inputs [B]", "outputs [B]"
SMALL, FAST = "code, -Os [B]", "code, -O2 [B]"
_FACTS = ("Date", "Processor", "System", "Load before the start")


def machine_facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine whatever runs on it."""
    return [fact for fact in machine.description() if fact[0] in _FACTS]


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine before anything is timed."""
    said = f"{compiler_family()} for {platform.machine()}: {compiler_version()}"
    return [*machine_facts(), (COMPILER, said)]


def sizes(found: Sequence[ExportedTimes], described: list[tuple[str, str]], rounds: int) -> str:
    """Return the tables of the page about exported code."""
    extents = table(
        [CONTROLLER, "process", LINES, OPERATIONS, STATE, PARAMETERS, INPUTS, OUTPUTS],
        [
            [
                each.name,
                each.process,
                f"{each.extent.lines:,}",
                f"{each.extent.operations:,} ({each.extent.slow:,})",
                *(
                    f"{getattr(each.double.data, what)} / {getattr(each.single.data, what)}"
                    for what in ("state", "parameters", "inputs", "outputs")
                ),
            ]
            for each in found
        ],
    )
    blocks = table(
        [CONTROLLER, BEFORE, OWN, SHARE, LIBRARY],
        [
            [
                each.name,
                f"{before:,}" if (before := LINES_BEFORE.get(each.name)) else "–",
                f"{each.extent.own:,}",
                f"{each.extent.own / before:.0%}" if before else "–",
                f"{each.extent.lines - each.extent.own:,}",
            ]
            for each in found
        ],
    )
    code = table(
        [CONTROLLER, SMALL, FAST, "double [ns a scan]", "single [ns a scan]"],
        [
            [
                each.name,
                *(
                    f"{getattr(each.double.code, what):,} / {getattr(each.single.code, what):,}"
                    for what in ("small", "fast")
                ),
                *(with_spread(c.time.times(1e9), 0) for c in (each.double, each.single)),
            ]
            for each in found
        ],
    )
    return "\n\n".join(
        [
            "### On any machine",
            "Double precision before the stroke, single precision behind it. Of the operations "
            "those in brackets are quotients, roots and functions of the mathematical library; "
            "what stands in a condition counts, as the program that MPC solves in few scans.",
            extents,
            "Until November 2026 a law was printed as one list of operations; now each of its "
            "blocks is one FUNCTION_BLOCK, written once however often it is called, and a "
            "controller only wires them. Lines of Structured Text:",
            blocks,
            "### On this one",
            table(["", ""], described),
            f"Median over {rounds} rounds, smallest and largest in brackets.",
            code,
            _an_operation(found),
        ]
    )


def _an_operation(found: Sequence[ExportedTimes]) -> str:
    each_takes = {c.name: 1e9 * c.double.time.median / c.extent.always for c in found}
    ordered = sorted(each_takes, key=each_takes.__getitem__)
    least, most = ordered[0], ordered[-1]
    return (
        f"In double precision an operation that no scan passes over takes from "
        f"{each_takes[least]:.2f} ns ({least}) to {each_takes[most]:.2f} ns ({most})."
    )


def times(found: Sequence[ExportedTimes], described: list[tuple[str, str]], rounds: int) -> str:
    """Return the section of the page about benchmarks."""
    rows = [
        [
            each.name,
            each.process,
            with_spread(each.double.time.times(1e9), 0),
            with_spread(each.single.time.times(1e9), 0),
            with_spread(each.engine.times(1e9), 0),
            with_spread(each.batch.times(1e9), 1),
            with_spread(each.ratio, 2),
        ]
        for each in found
    ]
    heads = [
        CONTROLLER, "process", "exported C, double [ns a scan]", "exported C, single [ns a scan]",
        "engine, one run [ns a scan]", "engine, batch [ns a scan and scenario]",
        "engine, one run, over exported C, double",
    ]  # fmt: skip
    above = sum(each.ratio.median > 1.0 for each in found)
    return "\n\n".join(
        [
            table(["", ""], described),
            f"Median over {rounds} rounds, smallest and largest in brackets; the last column is "
            "taken within each round. In double precision engine and exported C gave the same "
            f"outputs in every bit. One run of the engine takes longer than exported C for {above} "
            f"of the {len(found)} controllers.",
            table(heads, rows),
        ]
    )


def write_pages(
    found: Sequence[ExportedTimes],
    described: list[tuple[str, str]],
    rounds: int,
    *,
    benchmarks: Path = PAGE,
    code: Path = SIZES_PAGE,
) -> None:
    """Put the tables between their marks of both pages."""
    write(times(found, described, rounds), benchmarks, MARKS)
    write(sizes(found, described, rounds), code, MARKS)
