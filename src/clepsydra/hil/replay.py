"""A run on wires computed again: the law on what the PLC read, the process on what moved it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from clepsydra.base.signal import Signal, path
from clepsydra.deploy.proof.comparison import Difference, compare
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.engine.kernel import Kernel
from clepsydra.hil.disturbed import disturbed_inputs
from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.scan_log import ScanLog
from clepsydra.loop.closed_loop import closed_loop, true_name
from clepsydra.loop.faults import APPLIED, FORCED
from clepsydra.loop.stepped_loop import NOBODY
from clepsydra.program.precision import Precision, in_single_arithmetic
from clepsydra.program.program import Program
from clepsydra.rig.plant import PlantSettings


def replay_law(program: Program, log: ScanLog, precision: Precision = "double") -> Difference:
    """Run the simulated law on all that a PLC read, with its time steps, and compare the outputs.

    Where its power was off the law begins anew, with its state or without, as the PLC did.

    Parameters
    ----------
    program : Program
        What the PLC's program was printed from.
    log : ScanLog
        Of the PLC.
    precision : {"double", "single"}
        That of the printed program; the law is computed in it.

    Returns
    -------
    Difference
        Of the outputs: none in any bit but for functions such as exp, see
        `clepsydra.deploy.proof.comparison.double_bound`.
    """
    given, kinds = log.given(), {each.name: each.kind for each in program.inputs}
    if precision == "single":
        program = in_single_arithmetic(program)
        given = {
            name: column.astype(np.float32).astype(float) if kinds[name] == "real" else column
            for name, column in given.items()
        }
    first = [*np.flatnonzero(log.column("power") == 1.0).tolist(), len(log)]
    first = first if first[0] == 0 else [0, *first]
    outputs = len(program.outputs)
    stretches = [
        engine_run(program, {name: column[begin:end] for name, column in given.items()})[
            :, :outputs
        ]
        for begin, end in pairwise(first)
    ]
    found = log.found()
    shown = np.column_stack([found[signal.name] for signal in program.outputs])
    return compare(program.outputs, np.concatenate(stretches), shown)


def replay_plant(settings: PlantSettings, rows: PlantRows) -> Difference:
    """Run the simulated process with what the plant of a rig applied, and compare what it showed.

    The process runs as in any simulation, in one go and without a controller, from rest.

    Parameters
    ----------
    settings : PlantSettings
        Of the plant.
    rows : PlantRows
        From its first sample on.

    Returns
    -------
    Difference
        Of the states of the process, and of the measurements, as they are and as the sensors show
        them: none in any bit. Of a sensor that is made to show something else only the measurement
        as it is counts.
    """
    station = settings.station
    # Alarms look at the loop, and no process on its own has one.
    process = replace(station.loop.process, alarms=())
    program = closed_loop(
        process, NOBODY, substeps=station.substeps, readings=True, rims=True
    )  # fmt: skip
    begin = station.numbers.starts["rest"]
    known = {entry.name for entry in program.state}
    inputs = {s.name: np.full(rows.last + 1, s.initial) for s in program.inputs}
    given = disturbed_inputs(settings, rows, as_told=False)
    inputs |= {name: given[name] for name in inputs if name in given}
    inputs |= {path(u, "manual"): rows.column(path(u, APPLIED)) for u in process.inputs}
    inputs |= {path(u, "mode"): np.zeros(rows.last + 1) for u in process.inputs}
    run = Kernel(program, fuse=False).run(
        rows.last + 1,
        inputs=inputs,
        parameters={p.name: station.numbers.parameters[p.name] for p in program.parameters},
        state={name: value for name, value in begin.state.items() if name in known},
        rings={name: ring for name, ring in begin.rings.items() if name in known},
    )
    signals = [
        *process.state,
        *(replace(y, name=true_name(y)) for y in process.measurements),
        *process.measurements,
    ]
    expected = {signal.name: run.output(signal.name)[0] for signal in signals}
    found = {signal.name: rows.column(signal.name) for signal in signals}
    for y in process.measurements:
        forced = rows.column(path(y, FORCED)) != 0.0
        expected[y.name] = np.where(forced, found[y.name], expected[y.name])
    return compare(signals, _table(signals, expected), _table(signals, found))


def _table(signals: Iterable[Signal], columns: dict[str, np.ndarray]) -> np.ndarray:
    return np.column_stack([columns[signal.name] for signal in signals])
