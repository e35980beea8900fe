"""Trajectories as a file that other tools open: Parquet or CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run

if TYPE_CHECKING:
    import pyarrow


def write_parquet(runs: Sequence[Run], path: Path) -> None:
    """Write runs of one process as one table, whole or not at all.

    Parameters
    ----------
    runs : sequence of Run
        Of one process; one row a sample, runs one after the other.
    path : Path
        Column "controller" names the run, "time" [s] the start of the sample; every other
        column is a signal, its SI unit in the column's metadata under "unit".

    Raises
    ------
    InputError
        There is no run, or the file cannot be written.
    """
    if not runs:
        raise InputError("trajectories", [], "at least one run", "run a loop first")
    with whole_file(path) as part:
        _write_table(_table_of(runs), part)


def fitting(runs: Sequence[Run], largest: int) -> int:
    """Return of how many runs, from the first on, `write_parquet` makes one file; of one at least.

    Parameters
    ----------
    runs : sequence of Run
    largest : int
        What the file may have [bytes].

    Examples
    --------
    >>> import clepsydra as cl
    >>> run = cl.simulate("quadruple-tank", cl.design.simc("quadruple-tank"))
    >>> fitting([run, run, run], 1), fitting([run, run, run], 10_000_000)
    (1, 3)
    """
    import pyarrow

    size = 0
    for count, run in enumerate(runs):
        written = pyarrow.BufferOutputStream()
        _write_table(_table_of([run]), written)
        # Each has a head of its own, which a file of several has once.
        size += written.tell()
        if size > largest:
            return max(count, 1)
    return len(runs)


def _table_of(runs: Sequence[Run]) -> pyarrow.Table:
    # Controllers that move different inputs have different status words.
    signals = list({signal.name: signal for run in runs for signal in run.signals}.values())
    names = _repeated([run.controller.name for run in runs], [run.time.size for run in runs])
    columns = {
        "time": np.concatenate([run.time for run in runs]),
        **{s.name: np.concatenate([_values(run, s.name) for run in runs]) for s in signals},
    }
    return _table(columns, signals, runs[0].process.name, {"controller": names})


def _repeated(texts: Sequence[str], times: Sequence[int]) -> pyarrow.Array:
    """Return a column of texts, each so many times, that stores every text once."""
    import pyarrow

    places = {text: place for place, text in enumerate(dict.fromkeys(texts))}
    written = [text.encode() for text in places]
    ends = np.cumsum([0, *map(len, written)], dtype=np.int32)
    stored = map(pyarrow.py_buffer, (ends, b"".join(written)))
    dictionary = pyarrow.StringArray.from_buffers(len(places), *stored)
    rows = np.repeat(np.array([places[text] for text in texts], np.int32), times)
    return pyarrow.DictionaryArray.from_arrays(_column(rows, pyarrow.int32()), dictionary)


def _column(values: np.ndarray, kind: pyarrow.DataType) -> pyarrow.Array:
    """Return numbers as a column; pyarrow.array would import Pandas, which takes a while."""
    import pyarrow

    stored = pyarrow.py_buffer(np.ascontiguousarray(values, kind.to_pandas_dtype()))
    return pyarrow.Array.from_buffers(kind, len(values), [None, stored])


def _values(run: Run, name: str) -> np.ndarray:
    """Return a trajectory, not-a-number where the run has no such signal."""
    if any(signal.name == name for signal in run.signals):
        return run.values[name]
    return np.full(run.time.size, np.nan)


def write_columns(
    columns: Mapping[str, np.ndarray],
    signals: Iterable[Signal],
    process: str,
    path: Path,
) -> None:
    """Write trajectories as one table with their SI units, whole or not at all.

    Parameters
    ----------
    columns : mapping
        "time" [s] and the name of each signal to its values.
    signals : iterable of Signal
    process : str
        Its name.
    path : Path
    """
    with whole_file(path) as part:
        _write_table(_table(columns, signals, process, {}), part)


def _write_table(table: pyarrow.Table, place: Path | pyarrow.NativeFile) -> None:
    """Write a table; the bytes of numbers side by side by their place take half the room."""
    import pyarrow
    import pyarrow.parquet

    numbers = [field.name for field in table.schema if field.type == pyarrow.float64()]
    texts = [name for name in table.schema.names if name not in numbers]
    pyarrow.parquet.write_table(
        table, place, compression="zstd", use_dictionary=texts, use_byte_stream_split=numbers
    )


def _table(
    columns: Mapping[str, np.ndarray],
    signals: Iterable[Signal],
    process: str,
    labels: Mapping[str, pyarrow.Array],
) -> pyarrow.Table:
    """Return a table of columns of text and, behind them, of numbers with their units."""
    import pyarrow

    units = {"time": "s", **{signal.name: signal.unit for signal in signals}}
    schema = pyarrow.schema(
        [
            *(pyarrow.field(name, label.type) for name, label in labels.items()),
            *(
                pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit})
                for name, unit in units.items()
            ),
        ],
        metadata={"process": process},
    )
    numbers = {name: _column(values, pyarrow.float64()) for name, values in columns.items()}
    return pyarrow.table({**labels, **numbers}, schema=schema)


def write_trajectories(run: Simulation | Run, path: Path) -> None:
    """Write a simulation as one table, one row a sample, whole or not at all.

    Parameters
    ----------
    run : Simulation or Run
    path : Path
        Its ending says how: ".parquet", with the SI unit of each column in the column's metadata
        under "unit", or ".csv", in the units of the process file, with the unit in the head:
        "tank_1.level [cm]". A CSV number has 13 digits, or where it is in SI all that it takes to
        read the same double again.

    Raises
    ------
    InputError
        The ending is another one, or the file cannot be written.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from tempfile import TemporaryDirectory
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> with TemporaryDirectory() as folder:
    ...     write_trajectories(run, Path(folder) / "run.csv")
    ...     (Path(folder) / "run.csv").read_text().split(",")[:2]
    ['time [s]', 'tank_1.level [cm]']
    """
    ending = path.suffix.lower()
    if ending == ".parquet":
        columns = {"time": run.time, **{s.name: run.values[s.name] for s in run.signals}}
        write_columns(columns, run.signals, run.process.name, path)
    elif ending == ".csv":
        _write_csv(run, path)
    else:
        raise InputError(
            "trajectories", str(path), "a file that ends in .parquet or .csv", "rename it"
        )


def _write_csv(run: Simulation | Run, path: Path) -> None:
    columns = [run.time.tolist(), *(_shown(run.values[s.name], s) for s in run.signals)]
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time [s]", *(f"{s.name} [{s.shown_unit}]" for s in run.signals)])
        writer.writerows(zip(*columns, strict=True))


def _shown(values: np.ndarray, signal: Signal) -> list[float]:
    """Return values in the unit that the reader sees, without the digits that converting leaves."""
    if signal.shown_unit == signal.unit:
        return values.tolist()
    factor = from_si(1.0, signal.unit, signal.shown_unit)
    return [float(f"{value:.13g}") for value in (values * factor).tolist()]
