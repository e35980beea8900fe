"""What long work has found so far: in place on a terminal, elsewhere line by line."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType

#: Values of TERM of terminals that cannot overwrite a line.
_CANNOT_MOVE = ("dumb", "unknown")


@contextmanager
def shown_progress(
    found: Callable[[Any], RenderableType] | None = None,
    newest: Callable[[Any], str] | None = None,
    *,
    quiet: bool,
) -> Iterator[Callable[[Any], None] | None]:
    """Yield what shows how far long work is, until it ends; None where nobody would see it.

    It takes how much is `done`, `of` how much, and the `name` of what comes next.

    Parameters
    ----------
    found : callable, optional
        Returns what was found so far, which a terminal shows above the bar.
    newest : callable, optional
        Returns the last of it in a line, which is printed once where there is no terminal.
    quiet : bool
        Whether nothing but a result may be printed.
    """
    if quiet or sys.stderr is None:
        yield None
    elif sys.stderr.isatty() and os.environ.get("TERM") not in _CANNOT_MOVE:
        with _in_place(found) as tell:
            yield tell
    else:
        yield newest and _by_lines(newest)


@contextmanager
def _in_place(
    found: Callable[[Any], RenderableType] | None,
) -> Iterator[Callable[[Any], None]]:
    from rich.console import Console, Group
    from rich.live import Live
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    task, done = bar.add_task(""), -1
    with Live(bar, console=Console(stderr=True), transient=True) as live:

        def tell(progress: Any) -> None:
            nonlocal done
            bar.update(task, completed=progress.done, total=progress.of, description=progress.name)
            if found is not None and progress.done > done:
                done = progress.done
                live.update(Group(found(progress), bar), refresh=True)

        yield tell


def _by_lines(newest: Callable[[Any], str]) -> Callable[[Any], None]:
    printed, done = "", -1

    def tell(progress: Any) -> None:
        nonlocal printed, done
        if progress.done <= done:
            return
        line, done = newest(progress), progress.done
        if line not in ("", printed):
            printed = line
            with suppress(OSError):  # a closed stderr does not end the work
                print(line, file=sys.stderr, flush=True)

    return tell
