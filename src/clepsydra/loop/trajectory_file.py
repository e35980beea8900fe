"""The trajectories of a simulation as a file that other tools open."""

from __future__ import annotations

import csv
from pathlib import Path

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.parquet import write_columns
from clepsydra.loop.run import Run


def write_trajectories(run: Simulation | Run, path: Path) -> None:
    """Write a simulation as one table, one row a sample, whole or not at all.

    Parameters
    ----------
    run : Simulation or Run
    path : Path
        Its ending says how: ".parquet", with the SI unit of each column in the column's metadata
        under "unit", or ".csv", with the SI unit in the head: "tank_1.level [m]". A CSV number
        has all the digits that it takes to read the same double again.

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
    ['time [s]', 'tank_1.level [m]']
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
    columns = [run.time, *(run.values[signal.name] for signal in run.signals)]
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["time [s]", *(f"{s.name} [{s.unit}]" for s in run.signals)])
        writer.writerows(zip(*(column.tolist() for column in columns), strict=True))
