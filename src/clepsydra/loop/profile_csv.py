"""Profiles of inputs and disturbances from a CSV file."""

from __future__ import annotations

import math
from pathlib import Path

from clepsydra.base.arguments import require_signal
from clepsydra.base.csv_table import SignalOf, read_csv
from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.loop.profile import Change, check_range, outside_signal
from clepsydra.process.process import Process

#: Each row becomes a change of each signal; of so many, this takes seconds.
_MOST_ROWS = 200_000
_GAP = "fill the gap; a value is held until the next row"


def read_profile_csv(path: str | Path, process: Process) -> list[Change]:
    """Read the values of signals over time; each is held until the next row.

    The head names time and signals with their units: ``time [min],pump_1 [V]``. Columns are
    separated by commas or semicolons; numbers have a decimal point.

    Parameters
    ----------
    path : str or Path
    process : Process

    Returns
    -------
    list of Change
        Steps in order of time, for each signal one a row.

    Raises
    ------
    InputError
        The file cannot be read, or one of its cells cannot be used: its line and column are
        named.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.process.reader import load_process
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "pump.csv")
    ...     _ = path.write_text("time [min],pump_1 [V]\\n0,3\\n1,3.5\\n")
    ...     changes = read_profile_csv(path, load_process("quadruple-tank"))
    >>> changes[1].start, changes[1].value
    (60.0, 3.5)
    """

    def signal_of(name: str, unit: str | None, head: str, number: int) -> Signal:
        return outside_signal(name, process, f"{head}, column {number}")

    return _changes(path, signal_of)


def read_profile_of(path: Path, signal: Signal) -> list[Change]:
    """Read the values of one signal over time: a column of time, and one with its name.

    Raises
    ------
    InputError
        The file cannot be read, has a column of another signal, or one of its cells cannot be
        used.
    """

    def signal_of(name: str, unit: str | None, head: str, number: int) -> Signal:
        return require_signal(
            f"{head}, column {number}", name, (signal,), "the column of the signal"
        )

    return _changes(path, signal_of)


def _changes(path: str | Path, signal_of: SignalOf) -> list[Change]:
    table = read_csv(Path(path), _MOST_ROWS, _GAP, signal_of)
    changes: list[Change] = []
    last = -math.inf
    for row, (time, values) in enumerate(
        zip(table.time.tolist(), table.values.tolist(), strict=True)
    ):
        if time < 0.0 or time <= last:
            expected = "a time from 0 s on" if time < 0.0 else "a time after that of the last row"
            raise InputError(
                table.place(row),
                f"{table.rows[row][1][0].strip()} {table.time_unit}",
                expected,
                "sort the rows by time, with one row for each time",
            )
        last = time
        for signal, value in zip(table.signals, values, strict=True):
            place = table.place(row, signal.name)
            check_range(signal, value, place)
            changes.append(Change(signal.name, value, time, time, place))
    return changes
