"""The README's two lines, as a reader pastes them, each in a fresh copy of a tree."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from benchmarks.studies.processes import Ended, ProcessFailed, ended
from benchmarks.studies.row import AFTER, BEFORE, Row, Wanted
from benchmarks.studies.trees import Tree, plain_environment

T = TypeVar("T")

_FIRST = "README line 1"
_SECOND = "README line 2, installation and tests with two workers, byte code written"
_TESTS_FAILED = 1  # the status of pytest; what they took is known all the same


@dataclass(frozen=True)
class Installed:
    """What the first line took.

    Parameters
    ----------
    installation, study : float
        Processor time of the installation, and of the study after it [s].
    size : float
        Of the environment in the end [GB].
    """

    installation: float
    study: float
    size: float


class InstallationTimes:
    """The measurements of installations; pip finds packages where it is configured to.

    Parameters
    ----------
    after : Tree
    before : Tree or None
    folder : Path
        For the copies; made here.
    tell : callable
        Told what is measured next.
    """

    def __init__(
        self, after: Tree, before: Tree | None, folder: Path, tell: Callable[[str], None]
    ) -> None:
        trees = {BEFORE: before, AFTER: after}
        self._trees = {name: tree for name, tree in trees.items() if tree is not None}
        self._folder, self._tell = folder, tell
        folder.mkdir(parents=True)
        #: What has to be said of a line beside its numbers.
        self.notes: list[str] = []

    def rows(self, rounds: int) -> list[Row]:
        """Run the first line some times, and the second once."""
        first = self._in_turn(_FIRST, self._first_line, rounds)
        second = self._in_turn(_SECOND, self._second_line, 1)
        self.notes += [
            f"{_SECOND}, {name}: {_last_line(tested)}" for name, (tested,) in second.items()
        ]
        return [
            Row.of(f"{_FIRST}, installation [s]", _each(first, lambda i: i.installation),
                   Wanted(0.8, ratio=True), digits=1),
            Row.of(f"{_FIRST}, the study after it [s]", _each(first, lambda i: i.study),
                   None, digits=1),
            Row.of(f"{_FIRST}, environment after it [GB]", _each(first, lambda i: i.size),
                   Wanted(1.07)),
            Row.of(f"{_SECOND} [min on the clock]", _each(second, lambda e: e.clock / 60.0),
                   Wanted(12.0), digits=1),
            Row.of(f"{_SECOND} [min of processor]", _each(second, lambda e: e.processor / 60.0),
                   None, digits=1),
        ]  # fmt: skip

    def _in_turn(self, what: str, run: Callable[[Tree], T], rounds: int) -> dict[str, list[T]]:
        """Return what each side took in each round, without a side that failed."""
        found: dict[str, list[T]] = {name: [] for name in self._trees}
        order = list(self._trees.items())
        for number in range(rounds):
            for name, tree in order[:: -1 if number % 2 else 1]:
                if name not in found:
                    continue
                self._tell(f"{what}, {name}: {tree.commit}")
                try:
                    found[name].append(run(tree))
                except ProcessFailed as failure:
                    self.notes.append(f"{what}, {name}, failed: {failure}")
                    del found[name]
        return found

    def _first_line(self, tree: Tree) -> Installed:
        installation, _, study = tree.readme_lines()[0].rpartition(" && ")
        with self._copy(tree) as place:
            installed = self._run(installation, Path(place))
            studied = self._run(study, Path(place))
            return Installed(installed.processor, studied.processor, _size(Path(place) / ".venv"))

    def _second_line(self, tree: Tree) -> Ended:
        with self._copy(tree) as place:
            return self._run(tree.readme_lines()[1], Path(place), allowed=_TESTS_FAILED)

    def _copy(self, tree: Tree) -> tempfile.TemporaryDirectory[str]:
        copy = tempfile.TemporaryDirectory(dir=self._folder)
        unneeded = shutil.ignore_patterns("__pycache__")
        shutil.copytree(tree.folder, copy.name, ignore=unneeded, dirs_exist_ok=True)
        return copy

    def _run(self, line: str, place: Path, *, allowed: int = 0) -> Ended:
        with tempfile.TemporaryDirectory(dir=self._folder) as kept:
            variables = {
                "CLEPSYDRA_CACHE": f"{kept}/kernels",
                "MPLCONFIGDIR": kept,
                "PYTEST_XDIST_AUTO_NUM_WORKERS": "2",
            }
            done = ended(["bash", "-c", line], plain_environment() | variables, place)
        if done.status not in (0, allowed):
            raise ProcessFailed(_last_line(done))
        return done


def _each(found: dict[str, list[T]], value: Callable[[T], float]) -> dict[str, list[float]]:
    return {name: [value(each) for each in values] for name, values in found.items()}


def _last_line(done: Ended) -> str:
    lines = done.said.strip().splitlines()
    return lines[-1].strip(" =.") if lines else f"exit status {done.status}"


def _size(folder: Path) -> float:
    """Return what a folder takes on disk [GB]."""
    blocks = sum(path.lstat().st_blocks for path in folder.rglob("*"))
    return blocks * 512 / 1e9
