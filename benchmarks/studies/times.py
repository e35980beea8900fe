"""What is measured of studies: every way in every round, each in a process of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from benchmarks.measure import Timings, Way, interleave
from benchmarks.studies.processes import ProcessFailed
from benchmarks.studies.row import AFTER, BEFORE, Row, Wanted
from benchmarks.studies.side import Side
from benchmarks.studies.trees import Tree

PROCESS = "quadruple-tank"
#: Plants of the documentation whose studies are long: 20,400 samples, and 30,600 of a stiff one.
PLANTS = {
    "surge-drum.toml": "docs/examples/surge-drum.toml",
    "surge-vessel.toml, sampled every 5 s over 42 h": "docs/examples/surge-vessel.toml",
}
_IMPORTED = "numpy, scipy.linalg, casadi, llvmlite.binding"
_MODULES = f"""
import sys
import clepsydra as cl
cl.design.simc(cl.load("{PROCESS}"))
print(sum(name.partition(".")[0] == "clepsydra" for name in sys.modules))
"""
#: Another period before the one that is timed, so that nothing is left to be loaded.
_TUNING = """
import time
from benchmarks import tuning
tuning.with_clepsydra(2e-2, tuning.GENERATIONS)()
start = time.process_time()
tuning.with_clepsydra(1e-2, tuning.GENERATIONS)()
print(time.process_time() - start)
"""
_TUNING_BY_SCIPY = """
import time
from benchmarks import tuning
tuning.simulate_with_scipy(tuning.START, 2e-2)
start = time.process_time()
tuning.with_scipy(1e-2)
print(time.process_time() - start)
"""
#: What is done in each round; most of it by both sides.
_UNIT, _SCIPY = "imports", "SciPy"
_TERMINAL, _FILE = "first row on a terminal", "first row in a file"
_FIRST, _AGAIN = "first time, kernels there", "again"
_TUNED = "tuned"


class StudyTimes:
    """The measurements of the table.

    Parameters
    ----------
    after : Tree
    before : Tree or None
    folder : Path
        For what they keep; empty at the start.
    tell : callable
        Told what is measured next.
    """

    def __init__(
        self, after: Tree, before: Tree | None, folder: Path, tell: Callable[[str], None]
    ) -> None:
        trees = {BEFORE: before, AFTER: after}
        self._sides = {name: Side(t, folder / name) for name, t in trees.items() if t is not None}
        self._after = self._sides[AFTER]
        self._tell = tell
        #: What has to be said of the earlier commit where a column is empty.
        self.notes: list[str] = []

    def rows(self, rounds: int, long_rounds: int) -> list[Row]:
        """Measure everything; studies of the long plants in fewer rounds."""
        return [
            *self._usual_study(rounds),
            *(row for plant in PLANTS.items() for row in self._long_study(*plant, long_rounds)),
            self._modules(),
            self._tuning(rounds),
        ]

    def _usual_study(self, rounds: int) -> list[Row]:
        study = f"`study {PROCESS}`"
        sides = self._able(study, lambda s: s.study(PROCESS, s.used))
        self._after.imports(_IMPORTED)
        found = _interleaved(
            rounds,
            [
                Way(_UNIT, lambda: self._after.imports(_IMPORTED)),
                *_ways(sides, _TERMINAL, lambda s: s.first_row(PROCESS, s.fresh, terminal=True)),
                *_ways(sides, _FILE, lambda s: s.first_row(PROCESS, s.fresh, terminal=False)),
                *_whole(sides, PROCESS),
            ],
        )
        unit = found.seconds[_UNIT]
        in_units = [
            (f"{study} until its first row, on a terminal [imports]", _TERMINAL),
            (f"{study} until its first line, in a file [imports]", _FILE),
        ]
        return [
            Row.of(f"imports of {_IMPORTED} [s]", {AFTER: unit}, None),
            *(
                Row.of(work, _over(_values(found, what), unit), Wanted(2.0))
                for work, what in in_units
            ),
            *_whole_rows(study, found, Wanted(0.4, ratio=True)),
        ]

    def _long_study(self, named: str, path: str, rounds: int) -> list[Row]:
        study, subject = f"`study {named}`", str(self._after.tree.folder / path)
        sides = self._able(study, lambda s: s.study(subject, s.used))
        found = _interleaved(rounds, _whole(sides, subject))
        return _whole_rows(study, found, Wanted(0.25, ratio=True))

    def _modules(self) -> Row:
        work = "`cl.design.simc(plant)` in a new process [modules of Clepsydra]"
        sides = self._able(work, lambda s: s.script(_MODULES, s.used))
        counts = {name: [side.script(_MODULES, side.used)] for name, side in sides.items()}
        return Row.of(work, counts, Wanted(150), digits=0)

    def _tuning(self, rounds: int) -> Row:
        work = (
            "minimax tuning of the averaging tank at 10 ms, all bounds [speed over SciPy's SLSQP "
            "with LSODA]"
        )
        sides = self._able(work, lambda s: s.script(_TUNING, s.used))
        found = _interleaved(
            rounds,
            [
                Way(_SCIPY, lambda: self._after.script(_TUNING_BY_SCIPY, self._after.used)),
                *_ways(sides, _TUNED, lambda s: s.script(_TUNING, s.fresh)),
            ],
        )
        times = _over(_values(found, _TUNED), found.seconds[_SCIPY])
        speeds = {side: [1.0 / time for time in values] for side, values in times.items()}
        return Row.of(work, speeds, Wanted(10.0, least=True), digits=1)

    def _able(self, work: str, once: Callable[[Side], object]) -> dict[str, Side]:
        """Do it once, so that all is compiled and kept, and return the sides that can do it."""
        sides = {}
        for name, side in self._sides.items():
            self._tell(f"{work}, {name}: {side.tree.commit}")
            try:
                once(side)
            except ProcessFailed as failure:
                if name == AFTER:
                    raise
                self.notes.append(f"{work}, {name}: {str(failure).strip().splitlines()[-1]}")
            else:
                sides[name] = side
        return sides


def _whole(sides: dict[str, Side], subject: str) -> list[Way]:
    return [
        *_ways(sides, _FIRST, lambda s: s.study(subject, s.fresh)),
        *_ways(sides, _AGAIN, lambda s: s.study(subject, s.used)),
    ]


def _whole_rows(study: str, found: Timings, wanted: Wanted) -> list[Row]:
    return [
        Row.of(f"{study}, {what} [s]", _values(found, what), wanted) for what in (_FIRST, _AGAIN)
    ]


def _ways(sides: dict[str, Side], what: str, call: Callable[[Side], float]) -> list[Way]:
    return [Way(f"{what}, {name}", lambda side=side: call(side)) for name, side in sides.items()]


def _values(found: Timings, what: str) -> dict[str, list[float]]:
    named = {side: f"{what}, {side}" for side in (BEFORE, AFTER)}
    return {side: found.seconds[name] for side, name in named.items() if name in found.seconds}


def _interleaved(rounds: int, ways: list[Way]) -> Timings:
    """Return what the ways measure themselves."""
    return interleave(ways, rounds, warm_up=False, timed=lambda run: run())


def _over(values: dict[str, list[float]], unit: list[float]) -> dict[str, list[float]]:
    """Return the values of each side over the unit of their round."""
    return {
        side: [a / b for a, b in zip(found, unit, strict=True)] for side, found in values.items()
    }
