"""Trajectories as Parquet, which other tools open."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.files import whole_file
from clepsydra.loop.run import Run


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
    >>> from tempfile import TemporaryDirectory
    >>> import pandas
    >>> from clepsydra.design.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> run = Loop(controller, analysis.model).run(default_scenario(analysis.model))
    >>> with TemporaryDirectory() as folder:
    ...     write_parquet([run], Path(folder) / "runs.parquet")
    ...     table = pandas.read_parquet(Path(folder) / "runs.parquet")
    >>> table["controller"][0], bool(table["pump_1"][0] == 3.0), len(table) == run.time.size
    ('PI, SIMC', True, True)
    """
    import pyarrow
    import pyarrow.parquet

    if not runs:
        raise InputError("trajectories", [], "at least one run", "run a loop first")
    signals = runs[0].signals
    names = pyarrow.array(
        [run.controller.name for run in runs for _ in run.time], pyarrow.string()
    ).dictionary_encode()
    columns = {
        "controller": names,
        "time": np.concatenate([run.time for run in runs]),
        **{s.name: np.concatenate([run.values[s.name] for run in runs]) for s in signals},
    }
    units = {"time": "s", **{signal.name: signal.unit for signal in signals}}
    schema = pyarrow.schema(
        [
            pyarrow.field("controller", names.type),
            *(
                pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit})
                for name, unit in units.items()
            ),
        ],
        metadata={"process": runs[0].process.name},
    )
    with whole_file(path) as part:
        pyarrow.parquet.write_table(pyarrow.table(columns, schema=schema), part)
