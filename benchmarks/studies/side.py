"""A tree that is measured: what its processes do, each in a folder of its own."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from benchmarks.studies.homes import with_kernels_alone
from benchmarks.studies.processes import succeeded, until_first_row
from benchmarks.studies.trees import Tree


@dataclass(frozen=True)
class Side:
    """A tree with its home folders.

    Parameters
    ----------
    tree : Tree
    folder : Path
        For its homes.
    """

    tree: Tree
    folder: Path

    @property
    def used(self) -> Path:
        """The home in which everything has been done before."""
        home = self.folder / "used"
        home.mkdir(parents=True, exist_ok=True)
        return home

    @property
    def fresh(self) -> Path:
        """The home with the kernels of the one that is used and nothing else kept, made anew."""
        return with_kernels_alone(self.used, self.folder / "fresh")

    def study(self, subject: str, home: Path) -> float:
        """Return the processor time of a whole study [s]."""
        return self._processor(self.tree.study(subject), home)

    def first_row(self, subject: str, home: Path, *, terminal: bool) -> float:
        """Return the processor time of the process until a study's first row [s]."""
        with tempfile.TemporaryDirectory() as place:
            command, variables = self.tree.study(subject), self.tree.environment(home)
            return until_first_row(command, variables, Path(place), terminal=terminal)

    def script(self, text: str, home: Path) -> float:
        """Return the number that a script in Python prints."""
        with tempfile.TemporaryDirectory() as place:
            variables = self.tree.environment(home)
            return float(succeeded([sys.executable, "-c", text], variables, Path(place)).said)

    def imports(self, modules: str) -> float:
        """Return the processor time of a process that imports modules and ends [s]."""
        return self._processor([sys.executable, "-c", f"import {modules}"], self.used)

    def _processor(self, command: list[str], home: Path) -> float:
        with tempfile.TemporaryDirectory() as place:
            return succeeded(command, self.tree.environment(home), Path(place)).processor
