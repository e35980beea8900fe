"""The process image: one file in memory through which the plant, its doors and its history meet."""

from __future__ import annotations

import mmap
import os
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

#: Of the samples that are kept for the history: so many bytes at most, and rows at least and most.
_KEPT_BYTES, _FEWEST_ROWS, _MOST_ROWS = 1 << 25, 128, 1 << 14
#: Words at the beginning: the mark of its layout, the version of what is published, the last
#: sample that the history has acknowledged, and which of the two snapshots is whole.
_MARK, _VERSION, _ACKNOWLEDGED, _WHOLE, _HEAD = 0, 1, 2, 3, 8
#: Reads of a publication that is being written, before its reader gives up.
_TRIES = 1000
_WORD = 8


@dataclass(frozen=True)
class ImageLayout:
    """What stands in a process image, and where.

    Parameters
    ----------
    published : tuple of str
        What the plant tells, by the names of its program's outputs, and of itself.
    written : tuple of str
        What moves it: commands of a controller, of an operator, of an instructor.
    remembered : int
        Numbers of which the plant goes on where it was killed.
    plant : str
        What tells its plant from every other.
    """

    published: tuple[str, ...]
    written: tuple[str, ...]
    remembered: int
    plant: str = ""

    @property
    def mark(self) -> int:
        """What an image of it begins with."""
        return zlib.crc32("\n".join((self.plant, *self.columns)).encode())

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of a row: what is published, then what was written when it was."""
        return (*self.published, *self.written)

    @cached_property
    def rows(self) -> int:
        """How many rows are kept for the history."""
        return min(max(_KEPT_BYTES // (_WORD * self._width), _FEWEST_ROWS), _MOST_ROWS)

    @property
    def _width(self) -> int:
        # Before its columns a row has its sample and its time.
        return 2 + len(self.columns)

    @property
    def size(self) -> int:
        """Its size [bytes]."""
        return _WORD * sum(self.parts)

    @property
    def parts(self) -> tuple[int, ...]:
        """The sizes of its parts [8 bytes].

        Head, what was told last, what is written, two snapshots, and the rows for the history.
        """
        snapshot, told = 1 + self.remembered, 2 + len(self.published)
        return _HEAD, told, len(self.written), snapshot, snapshot, self.rows * self._width


class Published(NamedTuple):
    """What the plant has told at once.

    Parameters
    ----------
    sample : int
        Counted from 0; −1 before the first.
    time : float
        Of the clock of the plant [s since 1970].
    values : ndarray
        In the order of `ImageLayout.published`.
    """

    sample: int
    time: float
    values: np.ndarray


class ImageOfAnother(Exception):
    """A file is no image of the layout."""


class ProcessImage:
    """A process image in a file that several processes map into their memory.

    The plant alone publishes; every other process reads, and writes single numbers, of which the
    last one counts. Nobody waits for anybody: what is published has a version that is odd while it
    changes, and who has read during a change reads once more. A process that is killed leaves no
    lock behind.

    Parameters
    ----------
    path : Path
    layout : ImageLayout
    new : bool
        Whether it is made anew, all zero; otherwise it goes on as it is.

    Raises
    ------
    ImageOfAnother
        The file has another layout.

    Examples
    --------
    >>> import tempfile
    >>> layout = ImageLayout(("level",), ("pump.command",), remembered=2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     image = ProcessImage(Path(folder) / "image", layout, new=True)
    ...     image.write("pump.command", 3.0)
    ...     image.publish(0, 1.8e9, np.array([0.4]))
    ...     told = image.published()
    ...     image.keep(told, image.written())
    ...     image.remember(1, [0.5, 0.0])
    ...     kept = image.kept_since(-1)
    >>> told.sample, told.values.tolist(), kept[:, 2:].tolist()
    (0, [0.4], [[0.4, 3.0]])
    """

    def __init__(self, path: Path, layout: ImageLayout, *, new: bool = False) -> None:
        self.layout = layout
        size = layout.size
        if new:
            with path.open("wb") as stream:
                _allocate(stream.fileno(), size)
        with path.open("r+b") as stream:
            if os.fstat(stream.fileno()).st_size != size:
                raise ImageOfAnother(str(path))
            self._memory = mmap.mmap(stream.fileno(), size)
        words = np.frombuffer(self._memory, np.float64)
        parts = np.split(words, np.cumsum(layout.parts))
        head, self._latest, self._written, first, second, rows, _ = parts
        self._head = head.view(np.int64)
        self._snapshots = first, second
        self._rows = rows.reshape(layout.rows, -1)
        self._places = {name: place for place, name in enumerate(layout.written)}
        self._told = {name: 2 + place for place, name in enumerate(layout.published)}
        if new:
            self._head[[_ACKNOWLEDGED, _WHOLE]] = -1
            self._head[_MARK] = layout.mark
        if self._head[_MARK] != layout.mark:
            raise ImageOfAnother(str(path))

    def write(self, name: str, value: float) -> None:
        """Let what moves the plant be a number from its next sample on [SI]."""
        self._written[self._places[name]] = value

    def written(self) -> np.ndarray:
        """Return a copy of all that moves the plant, in the order of the layout."""
        return self._written.copy()

    def read(self, name: str) -> float:
        """Return what the plant last told, or what moves it [SI].

        Raises
        ------
        KeyError
            The image has nothing of that name.
        """
        place = self._told.get(name)
        source, place = (self._latest, place) if place else (self._written, self._places[name])
        return float(source[place])

    def publish(self, sample: int, time: float, values: np.ndarray) -> None:
        """Tell what the plant shows at the beginning of a sample, as the plant alone does."""
        # Odd already where the one before was killed while it published.
        self._head[_VERSION] |= 1
        self._latest[0], self._latest[1], self._latest[2:] = sample, time, values
        self._head[_VERSION] += 1

    def keep(self, told: Published, written: np.ndarray) -> None:
        """Keep a sample that is over for the history, with all that moved the plant in it.

        It is there for readers from when the plant remembers where it stood after it.
        """
        row = self._rows[told.sample % len(self._rows)]
        row[0] = -1.0
        row[1], row[2:] = told.time, np.concatenate([told.values, written])
        row[0] = told.sample

    def published(self) -> Published:
        """Return what the plant has told last, all of one sample."""
        for _ in range(_TRIES):
            version = int(self._head[_VERSION])
            if version % 2 == 0:
                found = self._latest.copy()
                if int(self._head[_VERSION]) == version:
                    return Published(int(found[0]) if version else -1, float(found[1]), found[2:])
        # Who was killed while it published is started again, and publishes the sample anew.
        found = self._latest.copy()
        return Published(int(found[0]), float(found[1]), found[2:])

    def kept_since(self, sample: int, most: int = 4096) -> np.ndarray:
        """Return the rows behind a sample that are still kept, oldest first [rows, 2 + columns].

        Each begins with its sample and its time [s since 1970]; of what was overwritten none is
        there.
        """
        before = self.remembered()
        last = -1 if before is None else before[0] - 1
        # The oldest is left out: it may be overwritten while it is read.
        first = max(sample + 1, last - len(self._rows) + 2)
        numbers = np.arange(first, min(last + 1, first + most))
        rows = self._rows[numbers % len(self._rows)]
        return rows[rows[:, 0] == numbers]

    @property
    def acknowledged(self) -> int:
        """The last sample that the history has safe; −1 for none."""
        return int(self._head[_ACKNOWLEDGED])

    @acknowledged.setter
    def acknowledged(self, sample: int) -> None:
        self._head[_ACKNOWLEDGED] = sample

    def remember(self, sample: int, numbers: Sequence[float] | np.ndarray) -> None:
        """Keep where the plant stands before a sample; what was kept stays until this is whole."""
        place = 1 - max(int(self._head[_WHOLE]), 0)
        self._snapshots[place][0], self._snapshots[place][1:] = sample, numbers
        self._head[_WHOLE] = place

    def remembered(self) -> tuple[int, np.ndarray] | None:
        """Return the sample before which the plant last stood, and where; None before the first."""
        whole = int(self._head[_WHOLE])
        if whole < 0:
            return None
        found = self._snapshots[whole].copy()
        return int(found[0]), found[1:]


def _allocate(handle: int, size: int) -> None:
    """Give a new file its size, and its place on the disk.

    Whoever writes to a page of a mapped file for which a full disk has no place is killed.
    """
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(handle, 0, size)
    else:
        os.ftruncate(handle, size)
