"""What the processes of a rig report to the one that started them."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from multiprocessing.connection import Connection


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
    """

    source: str
    kind: Kind
    words: str
    time: float


#: Longer words would not go through a pipe at once.
_LONGEST = 1000


class Reporter:
    """The end of a pipe into which one process reports; it never waits.

    Where nobody takes the reports, as when the one that started it hangs, they are dropped: the
    plant goes on.
    """

    def __init__(self, source: str, pipe: Connection) -> None:
        self._source, self._pipe = source, pipe

    def ready(self, words: str = "") -> None:
        """Say that the work has begun."""
        self._send(Kind.READY, words)

    def event(self, words: str) -> None:
        """Say that something happened."""
        self._send(Kind.EVENT, words)

    def refused(self, words: str) -> None:
        """Say why the work cannot begin."""
        self._send(Kind.REFUSED, words)

    def _send(self, kind: Kind, words: str) -> None:
        report = Report(self._source, kind, words[:_LONGEST], time.time())
        with suppress(OSError, ValueError):
            self._pipe.send(report)
