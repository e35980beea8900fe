"""The last run of a rig's history as a record."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.history_reading import read_rows, read_runs, read_samples, read_signals
from clepsydra.base.words import time_text
from clepsydra.identification.record import MOST_ROWS, Record
from clepsydra.process.process import Process


def read_history(path: Path, process: Process | None = None, last: float | None = None) -> Record:
    """Read the last run of a history, or the end of it, while it may still grow.

    Parameters
    ----------
    process : Process, optional
        Whose signals are taken, with the names and units that they have there; all if left out.
    last : float, optional
        So much of its end, of the plant's time [s].

    Raises
    ------
    InputError
        The file is no history, has no samples, misses some, or has more than a fit takes.
    """
    runs = read_runs(path)
    found = read_samples(path, runs[-1].number) if runs else None
    if found is None:
        raise InputError(str(path), Finding("no samples"), "a run of a rig", "record for longer")
    run, (first, end) = runs[-1], found
    if last is not None:
        first = max(first, end + 1 - round(last / run.period))
    count = end + 1 - first
    if count > MOST_ROWS:
        raise InputError(
            str(path), f"{count} samples", f"at most {MOST_ROWS}",
            f'take the end of it, as in last="{time_text(MOST_ROWS * run.period / 2)}"',
        )  # fmt: skip
    known = {}
    if process is not None:
        groups = (process.state, process.inputs, process.disturbances, process.measurements)
        known = {signal.name: signal for group in groups for signal in group}
    signals = [
        known.get(signal.name, signal)
        for signal in read_signals(path)
        if process is None or signal.name in known
    ]
    names = [signal.name for signal in signals]
    rows = read_rows(path, run.number, names, since=first - 1, most=count)
    missing = np.flatnonzero(np.diff(rows.samples, prepend=first - 1) != 1)
    if missing.size:
        at = int(rows.samples[missing[0]])
        raise InputError(
            f"{path}, sample {at}", Finding("samples missing before it"), "every sample",
            f'take what comes after it, as in last="{time_text((end + 1 - at) * run.period)}"',
        )  # fmt: skip
    # What a run never had is no signal of it.
    whole = np.all(np.isfinite(rows.values), axis=0)
    values = {name: rows.values[:, place] for place, name in enumerate(names) if whole[place]}
    kept = tuple(signal for signal in signals if signal.name in values)
    return Record(str(path), kept, values, run.period, first * run.period)
