"""Trajectories as Parquet, which other tools open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.base.signal import Signal
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

    Examples
    --------
    >>> import clepsydra as cl
    >>> from tempfile import TemporaryDirectory
    >>> import pandas
    >>> plant = cl.load("quadruple-tank")
    >>> controller = cl.design.simc(plant)
    >>> run = cl.simulate(plant, controller, duration="1 min")
    >>> with TemporaryDirectory() as folder:
    ...     write_parquet([run], Path(folder) / "runs.parquet")
    ...     table = pandas.read_parquet(Path(folder) / "runs.parquet")
    >>> table["controller"][0], bool(table["pump_1"][0] == 3.0), len(table) == run.time.size
    ('PI, SIMC', True, True)
    """
    import pyarrow

    if not runs:
        raise InputError("trajectories", [], "at least one run", "run a loop first")
    # Controllers that move different inputs have different status words.
    signals = list({signal.name: signal for run in runs for signal in run.signals}.values())
    names = pyarrow.array(
        [run.controller.name for run in runs for _ in run.time], pyarrow.string()
    ).dictionary_encode()
    columns = {
        "time": np.concatenate([run.time for run in runs]),
        **{s.name: np.concatenate([_values(run, s.name) for run in runs]) for s in signals},
    }
    write_columns(columns, signals, runs[0].process.name, path, {"controller": names})


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
    labels: Mapping[str, pyarrow.Array] | None = None,
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
    labels : mapping, optional
        Columns of text that stand first.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import pandas
    >>> columns = {"time": np.arange(2.0), "pump_1": np.array([3.0, 3.5])}
    >>> with TemporaryDirectory() as folder:
    ...     write_columns(columns, [Signal("pump_1", "V")], "plant", Path(folder) / "a.parquet")
    ...     list(pandas.read_parquet(Path(folder) / "a.parquet"))
    ['time', 'pump_1']
    """
    import pyarrow
    import pyarrow.parquet

    labels = labels or {}
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
    with whole_file(path) as part:
        table = pyarrow.table({**labels, **columns}, schema=schema)
        pyarrow.parquet.write_table(table, part)
