"""The process that keeps the history of a rig."""

from __future__ import annotations

import sqlite3
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clepsydra.base.history_file import HistoryFile
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.report import Reporter
from clepsydra.rig.retention import Retention

#: How often it looks for new samples, and tries again where they could not be kept [s].
_EVERY, _AGAIN = 0.2, 1.0
#: How often it forgets what is too old or too much [s].
_FORGETS = 10.0


@dataclass(frozen=True)
class HistorySettings:
    """What the historian of a run keeps, and where.

    Parameters
    ----------
    path : Path
        Of the history.
    run : int
    names : tuple of str
        Columns of the image that are kept.
    retention : Retention
    """

    path: Path
    run: int
    names: tuple[str, ...]
    retention: Retention


def keep_history(
    reporter: Reporter, settings: HistorySettings, image: Path, layout: ImageLayout
) -> None:
    """Keep samples until the process is ended: each is acknowledged once it is on the disk."""
    historian = Historian(reporter, settings, ProcessImage(image, layout))
    reporter.ready()
    forgot = time.monotonic()
    while True:
        kept = historian.keep()
        if time.monotonic() - forgot > _FORGETS:
            historian.forget()
            forgot = time.monotonic()
        time.sleep(_EVERY if kept else _AGAIN)


class Historian:
    """What takes samples from an image into a history.

    Parameters
    ----------
    reporter : Reporter
    settings : HistorySettings
    image : ProcessImage
        What was acknowledged in it follows what is in the history.
    """

    def __init__(self, reporter: Reporter, settings: HistorySettings, image: ProcessImage) -> None:
        self._reporter, self._settings, self._image = reporter, settings, image
        self._history = HistoryFile(settings.path)
        places = {name: place for place, name in enumerate(image.layout.columns)}
        # A row begins with its sample and its time.
        self._columns = [0, 1, *(2 + places[name] for name in settings.names)]
        image.acknowledged = self._history.last(settings.run)
        self._in_trouble = False

    def close(self) -> None:
        """Close the history."""
        self._history.close()

    def keep(self) -> bool:
        """Keep all samples that are there; return whether they could be."""
        while len(rows := self._image.kept_since(self._image.acknowledged)):
            if not self._add(rows[:, self._columns]):
                return False
            first, due = int(rows[0, 0]), self._image.acknowledged + 1
            if first > due:
                self._reporter.event(
                    f"samples {due} to {first - 1} are lost for the history: it could not be "
                    "written for too long"
                )
            self._image.acknowledged = int(rows[-1, 0])
        return True

    def _add(self, rows: np.ndarray) -> bool:
        try:
            self._history.add(self._settings.run, self._settings.names, rows)
        except sqlite3.Error as error:
            if not self._in_trouble:
                self._reporter.event(
                    f"the history cannot be written ({error}); samples wait in memory; make room "
                    f"on the disk of {self._settings.path}"
                )
            self._in_trouble = True
            return False
        if self._in_trouble:
            self._reporter.event("the history is written again")
        self._in_trouble = False
        return True

    def forget(self) -> None:
        """Forget what is older, or more, than is to be kept."""
        retention = self._settings.retention
        try:
            if retention.age is not None:
                self._history.forget_before(self._image.published().time - retention.age)
            if retention.size is not None:
                self._history.forget_beyond(retention.size)
        except sqlite3.Error as error:
            self._reporter.event(f"old samples could not be forgotten ({error})")
