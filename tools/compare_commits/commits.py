"""A commit as a folder of its sources; "." is the working tree as it stands."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

#: What decides how a command behaves; the rest of a working tree is not looked at.
_BEHAVIOUR = ("src", "pyproject.toml")


class CommitError(Exception):
    """What was named is no commit of this repository."""


@dataclass(frozen=True)
class Commit:
    """What is compared.

    Parameters
    ----------
    named : str
        As the user wrote it.
    key : str
        Of the commit, or of the working tree's content.
    """

    named: str
    key: str

    @property
    def is_tree(self) -> bool:
        """Whether it is a working tree with changes."""
        return self.key.startswith("tree")

    def __str__(self) -> str:
        return f"{self.named} ({'changed' if self.is_tree else self.key[:9]})"


def find_commit(repository: Path, named: str) -> Commit:
    """Return the commit of a name; "." is the last commit where nothing has changed since.

    Raises
    ------
    CommitError
        There is no such commit.
    """
    if named == ".":
        if _git(repository, "status", "--porcelain", "--", *_BEHAVIOUR):
            return Commit(named, f"tree-{_digest(repository)}")
        return Commit(named, _git(repository, "rev-parse", "HEAD"))
    try:
        return Commit(named, _git(repository, "rev-parse", "--verify", f"{named}^{{commit}}"))
    except subprocess.CalledProcessError:
        raise CommitError(
            f"{named}: no commit of {repository}; name a commit, branch or tag, or '.' for the "
            "working tree"
        ) from None


@contextmanager
def checked_out(repository: Path, commit: Commit, folder: Path) -> Iterator[Path]:
    """Give a folder with the commit's files, and take it away."""
    if commit.is_tree:
        for name in _files(repository):
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(repository / name, target)
        yield folder
        return
    _git(repository, "worktree", "add", "--quiet", "--detach", str(folder), commit.key)
    try:
        yield folder
    finally:
        _git(repository, "worktree", "remove", "--force", str(folder))


def version_of(checkout: Path) -> str:
    """Return the version that a commit calls itself."""
    with (checkout / "pyproject.toml").open("rb") as file:
        return str(tomllib.load(file)["project"]["version"])


def repository_of(folder: Path) -> Path:
    """Return the repository that a folder lies in.

    Raises
    ------
    CommitError
        It lies in none.
    """
    try:
        return Path(_git(folder, "rev-parse", "--show-toplevel"))
    except subprocess.CalledProcessError:
        raise CommitError(f"{folder}: in no git repository; run it in one") from None


def _digest(repository: Path) -> str:
    whole = hashlib.sha256()
    for name in _files(repository):
        content = (repository / name).read_bytes()
        whole.update(f"{name}\0{len(content)}\0".encode() + content)
    return whole.hexdigest()


def _files(repository: Path) -> list[str]:
    """Return what the working tree holds, without what git ignores and what was deleted."""
    listed = _git(
        repository, "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--",
        *_BEHAVIOUR,
    )  # fmt: skip
    return [name for name in sorted(set(listed.split("\0"))) if (repository / name).is_file()]


def _git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=True
    )
    return done.stdout.strip()
