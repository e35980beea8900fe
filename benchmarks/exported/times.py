"""The time of exported C beside the engine's, and what its code takes.

Every controller stands in its plant shell, as it is exported. Engine and C compute the same scans
over the same inputs in one process; what they find must be equal in every bit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.experiments import Disagreement
from benchmarks.exported.built import CodeSize, DataSize, ExportedC
from benchmarks.exported.extent import Extent, extent_of
from benchmarks.exported.families import FAMILIES, AtWork, at_work
from benchmarks.measure import Spread, Way, interleave, on_one_core
from clepsydra.engine.kernel import Job, Kernel

SCANS = 10_000
#: A run takes about a millisecond: a round times so many.
CALLS = 5
#: A batch has so many scenarios and scans; its measurements and setpoints differ.
SCENARIOS, BATCH_SCANS = 64, 1_000
_DOUBLE, _SINGLE = "exported C, double", "exported C, single"
_ENGINE, _BATCH = "engine, one run", "engine, batch"


@dataclass(frozen=True)
class InPrecision:
    """What was found for the C of one precision.

    Parameters
    ----------
    data : DataSize
    code : CodeSize
    time : Spread
        [s a scan]
    """

    data: DataSize
    code: CodeSize
    time: Spread


@dataclass(frozen=True)
class ExportedTimes:
    """What was found for one controller.

    Parameters
    ----------
    name, process : str
    extent : Extent
    double, single : InPrecision
        The exported C.
    engine, batch : Spread
        One run of the engine, and one scenario in a batch [s a scan].
    ratio : Spread
        Time of the engine's one run over that of the exported C in double precision, each pair
        from the same round.
    """

    name: str
    process: str
    extent: Extent
    double: InPrecision
    single: InPrecision
    engine: Spread
    batch: Spread
    ratio: Spread


def measure(rounds: int, folder: Path, tell: Callable[[str], None]) -> list[ExportedTimes]:
    """Build the code of every controller, check it and time it.

    Parameters
    ----------
    rounds : int
    folder : Path
        Where the code is built.
    tell : callable
        Gets the name of each controller before it is measured.

    Raises
    ------
    Disagreement
        Engine and C differ in a bit.
    CompilerMissing
    RuntimeError
        See `ExportedC`.
    """
    found = []
    for number, name in enumerate(FAMILIES):
        tell(name)
        found.append(measure_one(at_work(name, SCANS), rounds, folder / str(number)))
    return found


def measure_one(work: AtWork, rounds: int, folder: Path) -> ExportedTimes:
    """Build, check and time one controller; see `measure`."""
    program, name = work.ready.program, work.name
    double = ExportedC(work.ready, "double", folder / "double")
    single = ExportedC(work.ready, "single", folder / "single")
    scans, single_scans = double.prepare(work.inputs), single.prepare(work.inputs)
    with on_one_core():
        one_run = Kernel(program).prepare(SCANS, inputs=work.inputs)
        scans.run()
        agree(name, one_run, 0, scans.outputs(), "exported C")
        few, varied = _batch(work)
        batch = Kernel(program, individual=tuple(varied)).prepare(BATCH_SCANS, inputs=few | varied)
        for scenario in (0, SCENARIOS - 1):
            its = double.prepare(few | {key: rows[scenario] for key, rows in varied.items()})
            its.run()
            agree(name, batch, scenario, its.outputs(), "exported C")
        timings = interleave(
            [
                Way(_DOUBLE, scans.run, CALLS),
                Way(_SINGLE, single_scans.run, CALLS),
                Way(_ENGINE, one_run.run, CALLS),
                Way(_BATCH, batch.run, CALLS),
            ],
            rounds,
        )
    double_time, single_time, engine = (
        timings.of(way).times(1.0 / SCANS) for way in (_DOUBLE, _SINGLE, _ENGINE)
    )
    return ExportedTimes(
        name,
        work.process,
        extent_of(work.ready),
        InPrecision(double.data, double.code, double_time),
        InPrecision(single.data, single.code, single_time),
        engine,
        timings.of(_BATCH).times(1.0 / (SCENARIOS * BATCH_SCANS)),
        timings.ratio(_ENGINE, _DOUBLE),
    )


def _batch(work: AtWork) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return shared inputs [scans], and measurements and setpoints [scenarios, scans].

    Scenario k lags k scans behind the first.
    """
    few = {name: values[:BATCH_SCANS] for name, values in work.inputs.items()}
    varied = {
        name: np.array([np.roll(values, scenario) for scenario in range(SCENARIOS)])
        for name, values in few.items()
        if name.endswith((".pv", ".sp"))
    }
    return few, varied


def agree(name: str, job: Job, scenario: int, found: np.ndarray, what: str) -> None:
    """Refuse outputs that differ from those of the engine in a bit.

    Raises
    ------
    Disagreement
    """
    engine = np.ascontiguousarray(job.run().record_of(scenario))
    if not np.array_equal(engine.view(np.int64), found.view(np.int64)):
        worst = float(np.nanmax(np.abs(engine - found)))
        raise Disagreement(f"{name}: {what} differs from the engine by up to {worst:.1e}")
