"""What a commit printed, on disk, so that it runs once and an interrupted comparison goes on."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import platform
import secrets
import shutil
import sys
from pathlib import Path
from typing import Any

from compare_commits.plan import Command

#: Files of this tool that decide what is recorded.
_DECIDES = ("plan.py", "outputs.py", "runner.py", "worker.py")


class Kept:
    """The records of one commit, one file a command.

    Parameters
    ----------
    caches : Path
        Folder of all of them.
    key : str
        Of the commit.
    """

    def __init__(self, caches: Path, key: str) -> None:
        self.folder = caches / f"{key[:60]}-{_circumstances()}"
        self.folder.mkdir(parents=True, exist_ok=True)
        #: Of the commit's kernels: warm from one command to the next.
        self.objects = self.folder / "objects"

    def load(self, command: Command) -> dict[str, Any] | None:
        """Return the record of a command; None where it is to be run."""
        try:
            record = json.loads(self._path(command).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return record if record.get("steps") == [list(step) for step in command.steps] else None

    def store(self, command: Command, record: dict[str, Any]) -> None:
        """Keep a record, whole or not at all."""
        path = self._path(command)
        part = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
        part.write_text(json.dumps(record), encoding="utf-8")
        part.replace(path)

    def forget_objects(self) -> None:
        """Remove the kernels, which a commit that has run needs no more."""
        shutil.rmtree(self.objects, ignore_errors=True)

    def _path(self, command: Command) -> Path:
        return self.folder / f"{hashlib.sha256(command.label.encode()).hexdigest()[:24]}.json"


def _circumstances() -> str:
    """Return a digest of this tool, the Python environment and the processor."""
    own = [(Path(__file__).parent / name).read_text(encoding="utf-8") for name in _DECIDES]
    packages = sorted(f"{p.name} {p.version}" for p in importlib.metadata.distributions())
    machine = [sys.version, platform.machine(), _processor()]
    return hashlib.sha256(repr([own, packages, machine]).encode()).hexdigest()[:12]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line for line in lines if line.startswith(("model name", "CPU part"))), "")
