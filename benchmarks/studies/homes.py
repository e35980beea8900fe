"""A home folder in which nothing is kept but kernels, beside one with all of the last study."""

from __future__ import annotations

import shutil
from pathlib import Path

_KEPT = Path(".cache", "clepsydra")
#: What machine code begins with, behind the digest that guards it.
_MACHINE_CODE, _NEAR_ITS_BEGINNING = b"\x7fELF", 128


def with_kernels_alone(used: Path, home: Path) -> Path:
    """Make `home` anew from one in which studies have run, and leave out all but their kernels."""
    shutil.rmtree(home, ignore_errors=True)
    shutil.copytree(used, home)
    for path in (home / _KEPT).rglob("*"):
        if path.is_file() and not is_kernel(path):
            path.unlink()
    return home


def is_kernel(path: Path) -> bool:
    """Return whether a file that was kept is a compiled kernel, whatever it is called."""
    with path.open("rb") as file:
        return _MACHINE_CODE in file.read(_NEAR_ITS_BEGINNING)
