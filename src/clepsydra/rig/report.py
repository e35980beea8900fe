"""What the processes of a rig report to the one that started them."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum

from clepsydra.base.errors import ClepsydraError


class Kind(Enum):
    """What a report is about."""

    #: It is at work.
    READY = "ready"
    #: Something happened that somebody may want to know later.
    EVENT = "event"
    #: It cannot begin, and why.
    REFUSED = "refused"


@dataclass(frozen=True)
class Report:
    """One report.

    Parameters
    ----------
    source : str
        Who reports: "plant", "history", "Modbus TCP".
    kind : Kind
    words : str
    time : float
        [s since 1970]
    error : ClepsydraError, optional
        Why it cannot begin.
    """

    source: str
    kind: Kind
    words: str
    time: float
    error: ClepsydraError | None = None

    def __str__(self) -> str:
        """Return it as a line of a terminal: when, who, what."""
        clock = time.strftime("%H:%M:%S", time.localtime(self.time))
        return f"{clock} {self.source}: {self.words}"


#: Longer words would not go through a pipe at once.
_LONGEST = 1000


class Reporter:
    """What one process reports with.

    Where nobody takes the reports they are dropped: the plant goes on.

    Parameters
    ----------
    source : str
        Who reports.
    send : callable
        Takes each report, as of the end of a pipe.
    """

    def __init__(self, source: str, send: Callable[[Report], object]) -> None:
        self._source, self._take = source, send

    def ready(self, words: str = "") -> None:
        """Say that the work has begun."""
        self._send(Kind.READY, words)

    def event(self, words: str) -> None:
        """Say that something happened."""
        self._send(Kind.EVENT, words)

    def refused(self, error: ClepsydraError) -> None:
        """Say why the work cannot begin."""
        self._send(Kind.REFUSED, str(error), error)

    def _send(self, kind: Kind, words: str, error: ClepsydraError | None = None) -> None:
        report = Report(self._source, kind, words[:_LONGEST], time.time(), error)
        with suppress(OSError, ValueError):
            self._take(report)
