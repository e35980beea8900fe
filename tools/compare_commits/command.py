"""The command line of the comparison."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from compare_commits import screen
from compare_commits.commits import (
    Commit,
    CommitError,
    checked_out,
    find_commit,
    repository_of,
    version_of,
)
from compare_commits.comparison import Comparison, compare
from compare_commits.difference import Bound
from compare_commits.kept import Kept
from compare_commits.plan import Command
from compare_commits.runner import Runner, Side, WorkerError, was_stopped

_SAME, _DIFFERENT, _FAILED, _INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare two commits and return 0 without a difference, 1 with, 2 where it cannot be done."""
    asked = _parser().parse_args(arguments)
    try:
        repository = repository_of(Path.cwd())
        first, second = (find_commit(repository, named) for named in (asked.old, asked.new))
        bound = Bound(asked.bound, asked.floor)
        comparison = run(repository, first, second, bound, asked.cache, asked.limit)
    except (CommitError, WorkerError) as error:
        print(error, file=sys.stderr)
        return _FAILED
    except KeyboardInterrupt:
        print("\nInterrupted; the same command goes on from here.", file=sys.stderr)
        return _INTERRUPTED
    shown = screen.document if asked.json else screen.whole if asked.all else screen.screen
    print(shown(comparison, first, second))
    return _DIFFERENT if comparison.differences else _SAME


def run(
    repository: Path,
    first: Commit,
    second: Commit,
    bound: Bound,
    cache: Path,
    limit: float,
    commands: list[Command] | None = None,
) -> Comparison:
    """Run two commits where they have not run before, and compare what they printed.

    A commit against itself runs twice: what differs then is no commit's doing.
    """
    keys = (first.key, f"{second.key}-again" if second.key == first.key else second.key)
    began = time.monotonic()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="compare-"))).resolve()
        sides = []
        for commit, key, name in zip((first, second), keys, ("first", "second"), strict=True):
            checkout = stack.enter_context(checked_out(repository, commit, folder / name))
            sides.append(Side(checkout, version_of(checkout), Kept(cache.resolve(), key)))
        work = folder / "work"
        work.mkdir()
        Runner(sides, work, limit, _Progress(began), commands).run()
        for side in sides:
            if not any(was_stopped(record) for record in side.records.values()):
                side.kept.forget_objects()
    if sys.stderr.isatty():
        print(file=sys.stderr)
    for commit, side in zip((first, second), sides, strict=True):
        used = sum(record.get("processor_seconds", 0.0) for record in side.records.values())
        print(
            f"{commit}: {side.ran} of {len(side.records)} commands run now, the rest kept; "
            f"all together {used:.0f} s of processor",
            file=sys.stderr,
        )
    print(f"{time.monotonic() - began:.0f} s", file=sys.stderr)
    return compare(sides[0].records, sides[1].records, bound)


class _Progress:
    """Says how far it is: in place on a terminal, else a line every half minute."""

    _APART = 30.0

    def __init__(self, began: float) -> None:
        self._began = self._said = began

    def __call__(self, label: str, seconds: float, done: int, known: int) -> None:
        now = time.monotonic()
        line = f"{now - self._began:4.0f} s  {done} of {known}  {label} ({seconds:.1f} s)"
        if sys.stderr.isatty():
            print(f"\r\033[K{line[:79]}", end="", file=sys.stderr, flush=True)
        elif now - self._said > self._APART:
            self._said = now
            print(line, file=sys.stderr, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="compare_commits",
        description="Run every verb on the whole catalogue, and exports, at two commits, and list "
        "where numbers, keys, texts, files and exit statuses differ. What a commit printed is "
        "kept, so that it runs once; a commit against itself runs twice. Screens of verbs that "
        "print JSON, and messages for wrong input, are not looked at.",
        epilog="Exit status: 0 no difference, 1 some, 2 it cannot be done, 130 interrupted.",
    )
    parser.add_argument("old", metavar="OLD", help="a commit, branch or tag")
    parser.add_argument(
        "new", metavar="NEW", nargs="?", default=".",
        help="another, or . for the working tree, which it is if left out",
    )  # fmt: skip
    parser.add_argument(
        "--bound", type=float, default=Bound.relative, metavar="SHARE",
        help="numbers that differ by no more than this share of the larger are equal (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--floor", type=float, default=Bound.floor, metavar="NUMBER",
        help="and so are those that differ by no more than this (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--all", action="store_true", help="list every difference")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument(
        "--limit", type=float, default=300.0, metavar="SECONDS",
        help="a command that takes longer is stopped and reported (%(default)s)",
    )  # fmt: skip
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    parser.add_argument(
        "--cache", type=Path, default=caches / "clepsydra" / "comparisons", metavar="FOLDER",
        help="where what a commit printed is kept (%(default)s)",
    )  # fmt: skip
    return parser
