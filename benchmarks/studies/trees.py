"""The working tree and an earlier commit, each as a folder of its own that nothing was built in."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tarfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Between these lines of a README stand the commands that install and test.
_LINES = ("<!-- two lines -->", "<!-- end -->")
_START = [sys.executable, "-c", "from clepsydra.cli import main; main()"]
#: Variables that change what Python does or which Clepsydra it finds, and those of folders in
#: which something may have been kept.
_OF_PYTHON, _OF_FOLDERS = ("PYTHON", "CLEPSYDRA_"), ("XDG_", "MPLCONFIGDIR")


class GitFailed(RuntimeError):
    """Git refused, or this is no repository."""


class NoSuchCommit(RuntimeError):
    """What was named is no commit of this repository."""


@dataclass(frozen=True)
class Tree:
    """The files of a commit.

    Parameters
    ----------
    folder : Path
    commit : str
        As a reader can find it again.
    """

    folder: Path
    commit: str

    def readme_lines(self) -> tuple[str, str]:
        """Return the README's two lines: install and study, install and test."""
        text = (self.folder / "README.md").read_text(encoding="utf-8")
        between = text.partition(_LINES[0])[2].partition(_LINES[1])[0]
        study, test = (line for line in between.splitlines() if line.startswith("python3 "))
        return study, test

    def study(self, subject: str) -> list[str]:
        """Return the command of the README's study, with another subject in its place."""
        words = shlex.split(self.readme_lines()[0].rpartition(" && ")[2])
        subject_at = words.index("study") + 1
        return [*_START, *words[1:subject_at], subject, *words[subject_at + 1 :]]

    def environment(self, home: Path) -> dict[str, str]:
        """Return variables that a process of this tree gets, with a home folder of its own."""
        plain = {k: v for k, v in plain_environment().items() if not k.startswith(_OF_FOLDERS)}
        return plain | {
            "HOME": str(home),
            # Its benchmarks too, which know how to call it.
            "PYTHONPATH": os.pathsep.join([str(self.folder / "src"), str(self.folder)]),
            "TERM": "xterm",
            "COLUMNS": "100",
        }


def plain_environment() -> dict[str, str]:
    """Return this process's variables without those that are about Python or Clepsydra."""
    return {k: v for k, v in os.environ.items() if not k.startswith(_OF_PYTHON)}


def present(folder: Path) -> Tree:
    """Copy the working tree as it stands, without what git ignores."""
    listed = _git("ls-files", "-z", "--cached", "--others", "--exclude-standard")
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    changed = " with changes" if _git("status", "--porcelain") else ""
    return Tree(folder, _git("rev-parse", "--short=8", "HEAD") + changed)


def short_name(commit: str) -> str:
    """Return the short name of a commit.

    Raises
    ------
    NoSuchCommit
    """
    try:
        return _git("rev-parse", "--verify", "--short=8", f"{commit}^{{commit}}")
    except GitFailed:
        raise NoSuchCommit(f"--since {commit}: no commit of {ROOT}") from None


def earlier(commit: str, folder: Path) -> Tree:
    """Write the files of a commit into a folder."""
    name = short_name(commit)
    folder.mkdir(parents=True)
    packed = folder.with_suffix(".tar")
    _git("archive", "--format=tar", f"--output={packed}", name)
    with tarfile.open(packed) as archive:
        archive.extractall(folder, filter="data")
    packed.unlink()
    return Tree(folder, name)


def _git(*arguments: str) -> str:
    command = ["git", "-C", str(ROOT), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise GitFailed(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout.strip()
