"""How long the command line lets its user wait."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import clepsydra

_COMMAND = [sys.executable, "-c", "from clepsydra.cli import main; main()"]
#: Variables that would point to a cache that this machine has filled already.
_CACHES = ("CLEPSYDRA_CACHE", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")


@dataclass(frozen=True)
class Wait:
    """Seconds until the first line on standard output, and until the command was done."""

    first_line: float
    done: float


def wait_for(arguments: list[str], home: Path, folder: Path) -> Wait:
    """Run `clepsydra` with a home folder, in a folder, and measure the wait.

    A home folder that is empty stands for a new machine after install: no kernel, no font list,
    no unit registry is cached.

    Raises
    ------
    RuntimeError
        The command failed.
    """
    environment = {k: v for k, v in os.environ.items() if k not in _CACHES}
    environment |= {
        "HOME": str(home),
        "USERPROFILE": str(home),
        "PYTHONUNBUFFERED": "1",
        # The same Clepsydra as the rest of the benchmarks, wherever the command runs.
        "PYTHONPATH": str(Path(clepsydra.__file__).resolve().parents[1]),
    }
    start = time.perf_counter()
    with subprocess.Popen(
        [*_COMMAND, *arguments], cwd=folder, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        first = process.stdout.readline()
        first_line = time.perf_counter() - start
        text = first + process.stdout.read()
    if process.returncode:
        raise RuntimeError(f"clepsydra {' '.join(arguments)} failed:\n{text}")
    return Wait(first_line, time.perf_counter() - start)
