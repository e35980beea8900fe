"""A history: signals of runs, sample by sample, in a file of SQLite that is read while it grows."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clepsydra.base.conversion import conversion
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.signal import Signal

#: With what such a file begins.
MAGIC = b"SQLite format 3\x00"
#: SQLite has 2,000 columns at most, as it is usually built.
MOST_SIGNALS = 1900
#: How long it waits for another process that writes [s].
_PATIENCE = 10.0
#: Rows that are forgotten at a time, so that nobody waits long.
_AT_A_TIME = 200
_SCHEMA = """
CREATE TABLE IF NOT EXISTS runs (
  run INTEGER PRIMARY KEY, title TEXT NOT NULL, began REAL NOT NULL, period REAL NOT NULL
);
CREATE TABLE IF NOT EXISTS signals (
  name TEXT PRIMARY KEY, unit TEXT NOT NULL, shown_unit TEXT NOT NULL, words TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS samples (
  run INTEGER NOT NULL, sample INTEGER NOT NULL, time REAL NOT NULL, PRIMARY KEY (run, sample)
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS events (
  run INTEGER NOT NULL, time REAL NOT NULL, source TEXT NOT NULL, words TEXT NOT NULL
);
"""


@dataclass(frozen=True)
class HistoryRun:
    """A run of a history.

    Parameters
    ----------
    number : int
    title : str
    began : float
        [s since 1970]
    period : float
        Of its samples [s].
    """

    number: int
    title: str
    began: float
    period: float


class HistoryFile:
    """A history in a file, made where it is missing.

    Every value stands in SI in a column of the table `samples` that is named after its signal; the
    view `shown` has them in the units that readers see, named as in "level_1 [V]". What has been
    added is on the disk when `add` returns.

    Parameters
    ----------
    path : Path

    Raises
    ------
    InputError
        The file is no history, or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> signals = [Signal("level", "m", display_unit="cm"), Signal("pump", "V")]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with HistoryFile(Path(folder, "history.sqlite")) as history:
    ...         run = history.begin("tank", 1.8e9, 1.0, signals)
    ...         history.add(run, ["level", "pump"], np.array([[0.0, 1.8e9, 0.25, 3.0]]))
    ...         history.last(run)
    0
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        with self._told():
            self._connection = sqlite3.connect(path, timeout=_PATIENCE, isolation_level=None)
            for pragma in ("auto_vacuum=INCREMENTAL", "journal_mode=WAL", "synchronous=FULL"):
                self._connection.execute(f"PRAGMA {pragma}")
            self._connection.executescript(_SCHEMA)

    def __enter__(self) -> HistoryFile:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; what is in it stays."""
        self._connection.close()

    def begin(self, title: str, began: float, period: float, signals: Sequence[Signal]) -> int:
        """Begin a run, and return its number; the signals are all that its rows may have."""
        if len(signals) > MOST_SIGNALS:
            raise InputError(
                f"{self.path}, signals", len(signals), f"at most {MOST_SIGNALS}",
                "keep fewer of them in the history",
            )  # fmt: skip
        with self._told(), self._transaction() as cursor:
            known = {row[1] for row in cursor.execute("PRAGMA table_info(samples)")}
            for each in signals:
                if each.name not in known:
                    cursor.execute(f"ALTER TABLE samples ADD COLUMN {quoted(each.name)} REAL")
            cursor.executemany(
                "INSERT OR REPLACE INTO signals VALUES (?, ?, ?, ?)",
                [(s.name, s.unit, s.shown_unit, s.description) for s in signals],
            )
            cursor.execute(
                "INSERT INTO runs (title, began, period) VALUES (?, ?, ?)", (title, began, period)
            )
            number = cursor.lastrowid
            self._make_view(cursor)
        assert number is not None
        return number

    def last_run(self) -> HistoryRun | None:
        """Return the last run that was begun."""
        found = self._connection.execute(
            "SELECT run, title, began, period FROM runs ORDER BY run DESC LIMIT 1"
        ).fetchone()
        return None if found is None else HistoryRun(*found)

    def add(self, run: int, names: Sequence[str], rows: np.ndarray) -> None:
        """Add rows that begin with their sample and their time [s since 1970]; all or none.

        Raises
        ------
        sqlite3.Error
            As where the disk is full: nothing was added.
        """
        columns = ", ".join(["run", "sample", "time", *map(quoted, names)])
        marks = ", ".join("?" * (3 + len(names)))
        with self._transaction() as cursor:
            cursor.executemany(
                f"INSERT OR REPLACE INTO samples ({columns}) VALUES ({marks})",
                ((run, int(row[0]), *row[1:]) for row in rows.tolist()),
            )

    def tell(self, run: int, time: float, source: str, words: str) -> None:
        """Add an event."""
        with self._transaction() as cursor:
            cursor.execute("INSERT INTO events VALUES (?, ?, ?, ?)", (run, time, source, words))

    def last(self, run: int) -> int:
        """Return the last sample of a run; −1 for none."""
        found = self._connection.execute("SELECT max(sample) FROM samples WHERE run = ?", (run,))
        last = found.fetchone()[0]
        return -1 if last is None else int(last)

    def forget_before(self, time: float) -> int:
        """Forget the samples of before a time [s since 1970], and return how many."""
        return self._forget("SELECT run, sample FROM samples WHERE time < ? LIMIT ?", time)

    def forget_beyond(self, most: int) -> int:
        """Forget the oldest samples while the file holds more [bytes], and return how many."""
        forgotten = 0
        while self.size > most:
            oldest = "SELECT run, sample FROM samples ORDER BY run, sample LIMIT ?"
            gone = self._forget_some(oldest)
            forgotten += gone
            if not gone:
                break
        return forgotten

    @property
    def size(self) -> int:
        """What its tables take, without what is free in the file [bytes]."""
        pages, free, size = (
            self._connection.execute(f"PRAGMA {name}").fetchone()[0]
            for name in ("page_count", "freelist_count", "page_size")
        )
        return int((pages - free) * size)

    def _forget(self, oldest: str, *given: float) -> int:
        forgotten = 0
        while gone := self._forget_some(oldest, *given):
            forgotten += gone
        return forgotten

    def _forget_some(self, oldest: str, *given: float) -> int:
        with self._transaction() as cursor:
            found = cursor.execute(oldest, (*given, _AT_A_TIME)).fetchall()
            cursor.executemany("DELETE FROM samples WHERE run = ? AND sample = ?", found)
        self._connection.execute("PRAGMA incremental_vacuum").fetchall()
        return len(found)

    def _make_view(self, cursor: sqlite3.Cursor) -> None:
        shown = []
        signals = cursor.execute("SELECT name, unit, shown_unit FROM signals").fetchall()
        for name, unit, shown_unit in signals:
            way, column = conversion(unit, shown_unit), quoted(name)
            if way is not None:
                column += f" {'*' if way.code == 'multiply' else '/'} {way.number!r}"
            shown.append(f"{column} AS {quoted(f'{name} [{shown_unit}]')}")
        cursor.execute("DROP VIEW IF EXISTS shown")
        columns = ", ".join(["run", "sample", "time", *shown])
        cursor.execute(f"CREATE VIEW shown AS SELECT {columns} FROM samples")

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Cursor]:
        with closing(self._connection.cursor()) as cursor:
            cursor.execute("BEGIN IMMEDIATE")
            try:
                yield cursor
                cursor.execute("COMMIT")
            except BaseException:
                if self._connection.in_transaction:
                    cursor.execute("ROLLBACK")
                raise

    @contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise InputError(
                str(self.path), Finding(str(error)), "a history that can be written",
                "choose another folder, or make room on the disk",
            ) from None  # fmt: skip


def quoted(name: str) -> str:
    """Return the name of a column as SQL has it."""
    return '"' + name.replace('"', '""') + '"'
