"""Runs of a history, read while it may still grow."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.history_file import MAGIC, HistoryRun, quoted
from clepsydra.base.signal import Signal
from clepsydra.base.standing import Standing, standing_at

_EXPECTED = "a history that clepsydra rig wrote"


class HistoryRows(NamedTuple):
    """Samples of a run.

    Parameters
    ----------
    samples : ndarray [rows]
        Their numbers.
    time : ndarray [rows]
        [s since 1970]
    values : ndarray [rows, signals]
        In SI; not a number where nothing was kept.
    """

    samples: np.ndarray
    time: np.ndarray
    values: np.ndarray


def is_history(path: Path) -> bool:
    """Whether a file is a database of SQLite, as histories are; a pipe holds nobody up."""
    if standing_at(path, str(path), _EXPECTED) is not Standing.FILE:
        return False
    try:
        with path.open("rb") as stream:
            return stream.read(len(MAGIC)) == MAGIC
    except OSError:
        # Who reads it as something else tells why it cannot be.
        return False


def read_runs(path: Path) -> list[HistoryRun]:
    """Return the runs of a history, the oldest first.

    Raises
    ------
    InputError
        The file is no history, or damaged.
    """
    with _opened(path) as connection:
        found = connection.execute("SELECT run, title, began, period FROM runs ORDER BY run")
        return [HistoryRun(*row) for row in _all(path, found)]


def read_signals(path: Path) -> list[Signal]:
    """Return the signals of a history."""
    with _opened(path) as connection:
        found = connection.execute("SELECT name, unit, shown_unit, words FROM signals")
        return [Signal(n, unit, shown, description=words) for n, unit, shown, words in found]


def read_samples(path: Path, run: int) -> tuple[int, int] | None:
    """Return the first and the last sample of a run; None where it has none yet."""
    with _opened(path) as connection:
        found = connection.execute(
            "SELECT min(sample), max(sample) FROM samples WHERE run = ?", (run,)
        )
        first, last = _all(path, found)[0]
    return None if first is None else (int(first), int(last))


def read_rows(
    path: Path, run: int, names: Sequence[str], *, most: int, since: int = -1
) -> HistoryRows:
    """Return samples of a run behind one of them, the first of them if there are more than `most`.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.base.history_file import HistoryFile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "history.sqlite")
    ...     with HistoryFile(path) as history:
    ...         run = history.begin("tank", 1.8e9, 1.0, [Signal("level", "m")])
    ...         history.add(run, ["level"], np.array([[0.0, 1.8e9, 0.25], [1.0, 1.8e9, 0.5]]))
    ...         found = read_rows(path, read_runs(path)[-1].number, ["level"], most=10)
    >>> found.samples.tolist(), found.values.ravel().tolist()
    ([0, 1], [0.25, 0.5])
    """
    known = {signal.name for signal in read_signals(path)}
    for name in names:
        if name not in known:
            raise InputError(str(path), name, "a signal of the history", "choose another one")
    with _opened(path) as connection:
        found = connection.execute(
            f"SELECT {', '.join(['sample', 'time', *map(quoted, names)])} FROM samples "
            "WHERE run = ? AND sample > ? ORDER BY sample LIMIT ?",
            (run, since, most),
        )
        rows = np.array(_all(path, found), dtype=float).reshape(-1, 2 + len(names))
    return HistoryRows(rows[:, 0].astype(int), rows[:, 1], rows[:, 2:])


def _opened(path: Path) -> closing[sqlite3.Connection]:
    """Open a file for reading alone, whatever it is called."""
    try:
        connection = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)
        connection.execute("SELECT run FROM runs LIMIT 1").fetchall()
    except sqlite3.Error as error:
        raise _unreadable(path, error) from None
    return closing(connection)


def _all(path: Path, found: sqlite3.Cursor) -> list[tuple]:
    try:
        return found.fetchall()
    except sqlite3.Error as error:
        raise _unreadable(path, error) from None


def _unreadable(path: Path, error: sqlite3.Error) -> InputError:
    return InputError(str(path), Finding(str(error)), _EXPECTED, "check the path")
