"""How far long work is, on a terminal, and nothing elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType


@contextmanager
def shown_progress(
    found: Callable[[Any], RenderableType] | None = None, *, quiet: bool
) -> Iterator[Callable[[Any], None] | None]:
    """Yield what shows how far long work is, until it ends; None where nobody would see it.

    It takes how much is `done`, `of` how much, and the `name` of what comes next.

    Parameters
    ----------
    found : callable, optional
        Returns what was found so far, which is shown above the bar.
    quiet : bool
        Whether nothing but a result may be printed.
    """
    if quiet:
        yield None
        return
    from rich.console import Console, Group
    from rich.live import Live
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    task, done = bar.add_task(""), -1
    with Live(bar, console=console, transient=True) as live:

        def tell(progress: Any) -> None:
            nonlocal done
            bar.update(task, completed=progress.done, total=progress.of, description=progress.name)
            if found is not None and progress.done > done:
                done = progress.done
                live.update(Group(found(progress), bar))

        yield tell
