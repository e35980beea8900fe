"""A progress bar on a terminal, and nothing elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol


class _Progress(Protocol):
    @property
    def done(self) -> int: ...
    @property
    def of(self) -> int: ...
    @property
    def name(self) -> str: ...


@contextmanager
def shown_progress(*, quiet: bool) -> Iterator[Callable[[_Progress], None] | None]:
    """Yield what shows how far long work is; None where nobody would see it.

    Parameters
    ----------
    quiet : bool
        Whether nothing but a result may be printed.
    """
    if quiet:
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("")

        def tell(progress: _Progress) -> None:
            bar.update(task, completed=progress.done, total=progress.of, description=progress.name)

        yield tell
