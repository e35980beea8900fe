"""MAT files that the page of a laboratory brings along, looked at before."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.designs.regulators.mat_file import read_mat
from clepsydra.laboratory.free_laws import STATES


def regulator_files(paths: Sequence[str | Path]) -> dict[str, bytes]:
    """Return what is in the files of regulators by their names.

    Raises
    ------
    InputError
        A file is none of a regulator, two have one name, or one has too many states.
    """
    found: dict[str, bytes] = {}
    for path in map(Path, paths):
        states = len(read_mat(path).A)
        if states > STATES:
            raise InputError(
                f"{path}, A", f"{states} × {states}", f"at most {STATES} states in a page",
                'reduce its order, as with balred, or name it in a study file, regulator = "'
                f'{path.name}", whose controllers a page can have',
            )  # fmt: skip
        if path.name in found:
            remedy = "give it once, or rename one"
            raise InputError("lab, regulators", path.name, "files of different names", remedy)
        found[path.name] = path.read_bytes()
    return found
