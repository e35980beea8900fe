"""The processes of a rig: each does one thing, tells how it goes, and ends with its parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

from clepsydra.base.errors import ClepsydraError
from clepsydra.rig.report import Report, Reporter

#: A process that is told to end has so long [s].
_PATIENCE = 5.0
#: What a process ends with that cannot begin; it is not started again.
REFUSED = 2
Work = Callable[..., None]


@dataclass
class Child:
    """A process of a rig, which can be started again.

    Parameters
    ----------
    title : str
        What reports call it.
    work : callable
        Of a module: it takes a `Reporter`, then the arguments, and works until it is ended.
    arguments : tuple
        They travel to the process.
    """

    title: str
    work: Work
    arguments: tuple[Any, ...]
    process: SpawnProcess | None = field(default=None, init=False)
    pipe: Connection | None = field(default=None, init=False)

    def start(self) -> None:
        """Start it, or start it again."""
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe(duplex=False)
        arguments = (self.title, self.work, theirs, self.arguments)
        self.process = context.Process(target=_at_work, args=arguments, daemon=True)
        self.process.start()
        theirs.close()

    @property
    def is_alive(self) -> bool:
        """Whether it is at work."""
        return self.process is not None and self.process.is_alive()

    @property
    def exit_code(self) -> int | None:
        """What it ended with; None while it works."""
        return None if self.process is None else self.process.exitcode

    def end(self) -> None:
        """Let it end: what it has not finished after some seconds is cut off."""
        if self.process is None:
            return
        self.process.terminate()
        self.process.join(_PATIENCE)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()


def reports_of(children: list[Child], seconds: float) -> list[tuple[Child, Report]]:
    """Return what children report, as soon as one does or after some time without any."""
    open_pipes = {each.pipe: each for each in children if each.pipe is not None}
    found = []
    for pipe in wait(list(open_pipes), seconds):
        assert isinstance(pipe, Connection)
        child = open_pipes[pipe]
        try:
            while pipe.poll():
                found.append((child, pipe.recv()))
        except (EOFError, OSError):
            pipe.close()
            child.pipe = None
    return found


def never_wait(pipe: Connection) -> None:
    """Let who sends into a full pipe be refused, and not wait until somebody reads.

    What fits into a page goes as a whole or not at all, so that no half of a report is left.
    """
    with suppress(OSError, AttributeError):  # where the system knows no such thing
        os.set_blocking(pipe.fileno(), False)


def _at_work(title: str, work: Work, pipe: Connection, arguments: tuple[Any, ...]) -> None:
    # Control-C goes to all; it is the parent that ends them, in order.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    never_wait(pipe)
    reporter = Reporter(title, pipe.send)
    try:
        work(reporter, *arguments)
    except ClepsydraError as error:
        reporter.refused(error)
        raise SystemExit(REFUSED) from None


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)
