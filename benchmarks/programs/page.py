"""The tables of quadratic programs, and their place in the documentation."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from benchmarks import machine
from benchmarks.measure import Spread
from benchmarks.page import PAGE, table, with_spread, write
from benchmarks.programs import times
from benchmarks.programs.times import ProgramTimes
from clepsydra.program.routines.quadratic_program import TURNS

MARKS = ("<!-- quadratic programs: begin -->", "<!-- quadratic programs: end -->")
_FACTS = ("Date", "Processor", "Vector sets", "System", "Load before the start")
_PACKAGES = ("casadi", "daqp", "do-mpc", "llvmlite", "numpy")


def facts() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine and of the solvers on it."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    told = [fact for fact in machine.description() if fact[0] in _FACTS]
    return [*told, ("Packages", packages)]


def render(found: Sequence[ProgramTimes], described: Sequence[tuple[str, str]], rounds: int) -> str:
    """Return the section as Markdown."""
    return "\n\n".join(
        [
            table(["", ""], described),
            f"Time of the processor, one core: median over {rounds} rounds, smallest and largest "
            "in brackets. Ratios are taken within each round.",
            _figures(found[-1]),
            *(_times(each) for each in found),
        ]
    )


def _figures(tank: ProgramTimes) -> str:
    """Compare what was measured of the tank's control with what was wanted."""

    def row(text: str, wanted: str, spread: Spread, met: bool, digits: int = 1) -> list[str]:
        return [text, wanted, with_spread(spread, digits), "yes" if met else "**no**"]

    over = {way: tank.timings.ratio(way, times.CLEPSYDRA) for way in (times.QPOASES, times.DO_MPC)}
    batch = tank.timings.ratio(times.QPOASES, times.BATCH)
    daqp = tank.timings.ratio(times.CLEPSYDRA, times.DAQP)
    one, few = tank.of(times.CLEPSYDRA), tank.of(times.FEWER)
    rows = [
        row(f"one after the other, {TURNS} turns [µs]", "at most 50", one, one.median <= 50),
        row("batch, 12 turns [µs]", "at most 6", few, few.median <= 6),
        *(
            row(f"speed over {way}", "at least 20", ratio, ratio.median >= 20)
            for way, ratio in over.items()
        ),
        row(f"speed of the batch over {times.QPOASES}", "at least 20", batch, batch.median >= 20),
        row("time over DAQP", "at most 3", daqp, daqp.median <= 3),
    ]
    return table(["quadruple tank, 10 unknowns, 40 rows", "wanted", "measured", "met"], rows)


def _times(found: ProgramTimes) -> str:
    rows = [
        [
            way,
            with_spread(found.of(way), 1),
            with_spread(found.timings.ratio(way, times.CLEPSYDRA), 2),
            f"{found.differences[way]:.0e}",
        ]
        for way in found.timings.seconds
    ]
    heads = ["way", "µs a program", "over Clepsydra's", "difference to DAQP at its closest"]
    title = (
        f"### {found.unknowns} unknowns, {found.rows} rows: {found.name}, {found.programs} programs"
    )
    alone = f"DAQP's own clock says {1e6 * found.daqp_alone:.1f} µs."
    return "\n\n".join([title, table(heads, rows), alone])


def write_page(text: str) -> None:
    """Put the section on its page."""
    write(text, PAGE, MARKS)
