"""The tables of draws, and their place in the documentation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import version

from benchmarks import machine
from benchmarks.draws import times
from benchmarks.draws.times import DrawTimes
from benchmarks.measure import Spread
from benchmarks.page import PAGE, table, with_spread, write

MARKS = ("<!-- draws: begin -->", "<!-- draws: end -->")
_FACTS = (
    "Date", "Processor", "Vector sets", "Memory", "System", "C++ compiler", "Load before the start"
)  # fmt: skip
_PACKAGES = ("jax", "llvmlite", "numpy")
_GIBIBYTE = 2.0**30


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine and of the ways on it."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    told = [fact for fact in machine.description() if fact[0] in _FACTS]
    return [*told, ("Packages", packages)]


def render(found: DrawTimes, described: Sequence[tuple[str, str]], rounds: int) -> str:
    """Return the section as Markdown."""
    return "\n\n".join(
        [
            table(["", ""], described),
            f"{found.draws:,} draws of {found.samples:,} samples on {times.CORES} cores; median "
            f"over {rounds} rounds, smallest and largest in brackets. Ratios are taken within "
            "each round.",
            _figures(found),
            _ways(found),
            "Largest relative difference between the ways: "
            f"{found.difference:.0e}, of the equilibria {found.resting:.0e}.",
        ]
    )


def _figures(found: DrawTimes) -> str:
    """Compare what was measured with what was wanted."""
    ratio = found.timings.ratio
    peak = found.peak / _GIBIBYTE

    def row(text: str, wanted: str, spread: Spread, met: Callable[[float], bool]) -> list[str]:
        verdict = "yes" if met(spread.median) else "**no**"
        return [text, wanted, with_spread(spread, 2), verdict]

    rows = [
        row("without noise, time over C++ by hand", "at most 1.6",
            ratio(times.QUIET, times.CPP), lambda v: v <= 1.6),
        row("with noise, time over C++ by hand without", "at most 2.2",
            ratio(times.NOISY, times.CPP), lambda v: v <= 2.2),
        row("equilibria alone, time over C++ by hand", "at most 0.5",
            ratio(times.REST, times.CPP), lambda v: v <= 0.5),
        row("without noise, speed over JAX", "at least 1",
            ratio(times.JAX, times.QUIET), lambda v: v >= 1.0),
        row("with noise, speed over JAX with noise", "at least 1",
            ratio(times.JAX_NOISY, times.NOISY), lambda v: v >= 1.0),
        [f"peak memory of {found.many:,} draws, scores alone [GiB]", "under 1", f"{peak:.2f}",
         "yes" if peak < 1.0 else "**no**"],
    ]  # fmt: skip
    return table(["draws", "wanted", "measured", "met"], rows)


def _ways(found: DrawTimes) -> str:
    rows = [
        [
            way,
            with_spread(found.timings.of(way), 3),
            with_spread(found.timings.ratio(way, times.CPP), 2),
        ]
        for way in found.timings.seconds
    ]
    return table(["way", "seconds", "time over C++"], rows)


def write_page(text: str) -> None:
    """Put the section on its page."""
    write(text, PAGE, MARKS)
