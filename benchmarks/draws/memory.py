"""The peak memory of a process that runs draws with their scores alone.

It is a process of its own, since a peak is that of a process as long as it lives.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import clepsydra
from benchmarks.draws.problem import problem
from clepsydra.studies.robustness.campaign import Campaign

_STATUS = Path("/proc/self/status")


def peak_of(draws: int, samples: int) -> int:
    """Return the peak resident memory [B] of a process that runs so many draws.

    Raises
    ------
    RuntimeError
        The process failed.
    """
    root = Path(__file__).resolve().parents[2]
    sources = Path(clepsydra.__file__).resolve().parents[1]
    code = f"import sys; sys.path[:0] = {[str(root), str(sources)]!r}; "
    code += f"from benchmarks.draws.memory import run; run({draws}, {samples})"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    if found.returncode:
        raise RuntimeError(f"{draws:,} draws failed:\n{found.stderr}")
    return int(found.stdout)


def run(draws: int, samples: int) -> None:
    """Run so many draws and print the peak of this process [B]."""
    tally = Campaign(problem(draws, samples).quiet, draws).run()
    assert tally.draws == draws
    print(_peak())


def _peak() -> int:
    # What getrusage says of a process begins with the peak of the one that started it.
    if _STATUS.exists():
        lines = dict(line.split(":", 1) for line in _STATUS.read_text().splitlines())
        return 1024 * int(lines["VmHWM"].split()[0])
    import resource  # Windows has none

    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size if sys.platform == "darwin" else 1024 * size
