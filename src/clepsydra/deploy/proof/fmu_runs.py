"""FMUs in a proof: for co-simulation in every scan, for model exchange at random states.

In model exchange the derivatives at random states are compared with those that CasADi evaluates,
so the importer integrates what the simulation integrates. How it integrates, and how it finds
events, is its own: the tests of the FMUs look at that.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.process import process_model
from clepsydra.deploy.fmi.write import FmiVersion, fmu_contents, write_fmu
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.comparison import compare, double_bound
from clepsydra.deploy.proof.imported_fmu import FmuError, rates_of_fmu, run_fmu
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Contents, Job
from clepsydra.deploy.proof.limits import DELAYS, PYTHON_LAW, Limit
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.linear.linearise import linearise
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.loop.step_size import substeps_for
from clepsydra.program.entries import is_ring


def fmu_runs(kind: str) -> list[Run]:
    """Return what is run of FMUs, one for each version; of a process for model exchange too.

    Raises
    ------
    InputError
        FMPy is not installed.
    """
    importer = version_of("FMPy")

    def runs(
        ending: str,
        against: str,
        model_of: Callable[[ProofItem], FmuModel],
        measure: Callable[..., Measured],
        *limits: Limit,
    ) -> list[Run]:
        return [
            Run(
                f"FMU {version}{ending}",
                "double",
                against,
                importer,
                partial(_printed, version=version, model_of=model_of),
                partial(measure, version=version),
                limits,
                in_si=True,
            )
            for version in get_args(FmiVersion)
        ]

    found = runs("", "engine", _model_of, _measured, PYTHON_LAW)
    if kind == "process":
        found += runs(" exchange", "CasADi", _exchange_of, _measured_exchange, PYTHON_LAW, DELAYS)
    return found


def _printed(job: Job, version: FmiVersion, model_of: Callable[[ProofItem], FmuModel]) -> Contents:
    """Return the files of an FMU, all but its binary."""
    return fmu_contents(model_of(job.item), version)


def _model_of(item: ProofItem) -> FmuModel:
    """Return the model for co-simulation of a controller or a process."""
    if item.kind == "process" and item.point is not None:
        return process_model(item.point, substeps_for(linearise(item.point)), _origin_of(item))
    assert item.program is not None
    return controller_model(item.program, _origin_of(item))


def _exchange_of(item: ProofItem) -> FmuModel:
    assert item.point is not None
    return exchange_model(item.point, _origin_of(item))


def _origin_of(item: ProofItem) -> Origin:
    return item.origin or Origin(item.name, "a process", "", item.sampling_period)


def _built(job: Job, model: FmuModel, contents: Contents, version: FmiVersion) -> Path:
    """Build the FMU of a model, and refuse it where it holds other files than were printed."""
    job.folder.mkdir(parents=True, exist_ok=True)
    path = job.folder / f"{model.name}-{version}.fmu"
    write_fmu(path, model, job.compiler, version=version)
    with zipfile.ZipFile(path) as archive:
        held = {n: archive.read(n) for n in archive.namelist() if not n.startswith("binaries/")}
    if held != dict(contents):
        raise FmuError(f"{path.name}: it holds other files than were printed")
    return path


def _measured(job: Job, contents: Contents, version: FmiVersion) -> Measured:
    path = _built(job, _model_of(job.item), contents, version)
    period, folder = job.item.sampling_period, job.folder / path.stem
    shown, found = run_fmu(job.program, path, folder, period, job.inputs)
    # A delay ring is no variable of an FMU.
    kept = [True] * len(job.program.outputs) + [not is_ring(e) for e in job.program.state]
    difference = compare(shown, job.engine[:, np.array(kept, dtype=bool)], found)
    return difference, double_bound(job.program), {}


def _measured_exchange(job: Job, contents: Contents, version: FmiVersion) -> Measured:
    point = job.item.point
    assert point is not None
    path = _built(job, _exchange_of(job.item), contents, version)
    random = np.random.default_rng((job.seed, 2))
    motion, process = point.process.motion, point.process
    held = _random_rows(motion.contents, job.scans, random)
    outside = _random_rows((*process.inputs, *process.disturbances), job.scans, random)
    expected = _by_casadi(point, held, outside)
    names = [signal.name for signal in (*process.inputs, *process.disturbances)]
    found = rates_of_fmu(path, job.folder / path.stem, held, outside, names)
    shown = [Signal(f"der({signal.name})") for signal in motion.contents]
    # CasADi does not keep the sign of a zero.
    return compare(shown, expected + 0.0, found + 0.0), double_bound(job.program), {}


def _random_rows(signals: Sequence[Signal], count: int, random: np.random.Generator) -> Array:
    """Draw values of signals from their ranges [count, signals]."""
    columns = []
    for signal in signals:
        low = signal.low if math.isfinite(signal.low) else 0.0
        high = signal.high if math.isfinite(signal.high) else low + max(1.0, abs(signal.initial))
        columns.append(random.uniform(low, high, count))
    return np.column_stack(columns) if columns else np.zeros((count, 0))


def _by_casadi(point: OperatingPoint, contents: Array, outside: Array) -> Array:
    process = point.process
    rest = motion_at_rest(point)
    memories = np.array([rest[signal.name] for signal in process.motion.memories])
    inputs, disturbances = outside[:, : len(process.inputs)], outside[:, len(process.inputs) :]
    rows = [
        np.array(process.motion.rates(c, [], memories, u, d, process.parameter_values)[0]).ravel()
        for c, u, d in zip(contents, inputs, disturbances, strict=True)
    ]
    return np.array(rows)
