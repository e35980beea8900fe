"""FMUs for model exchange in a proof: derivatives at random points."""

from __future__ import annotations

import ctypes
import math
import shutil
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, get_args

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.deploy.fmi.write import FmiVersion, fmu_contents
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.comparison import compare, double_bound
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.fmu_runs import built
from clepsydra.deploy.proof.imported_fmu import FmuError, importer
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.limits import DELAYS, PYTHON_LAW
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import motion_at_rest


def exchange_runs() -> list[Run]:
    """Return what is run of FMUs for model exchange, one for each version of the interface.

    The trajectory of such an FMU is the importer's, so what is compared are the derivatives of
    the contents, at as many random points as a proof has scans: with CasADi's evaluation of the
    equations, in which the sign of a zero is not kept.

    Raises
    ------
    InputError
        The importer is missing.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.deploy.compiler import find_compiler
    >>> from clepsydra.deploy.proof.item import process_item
    >>> from clepsydra.linear.equilibrium import find_equilibrium
    >>> from clepsydra.process.reader import load_process
    >>> item = process_item(find_equilibrium(load_process("quadruple-tank")))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     job, run = Job(item, 100, 1, Path(folder), find_compiler("example")), exchange_runs()[1]
    ...     run.measure(job, run.printed(job))[0].differing
    0
    """
    version_told = version_of("FMPy")
    return [
        Run(
            f"FMU {version} exchange",
            "double",
            "CasADi",
            version_told,
            partial(_printed, version=version),
            partial(_measured, version=version),
            (PYTHON_LAW, DELAYS),
            in_si=True,
        )
        for version in get_args(FmiVersion)
    ]


def _printed(job: Job, version: FmiVersion) -> Contents:
    """Return the files of an FMU for model exchange, all but its binary."""
    return fmu_contents(exchange_model(*_of_process(job.item)), version)


def _measured(job: Job, contents: Contents, version: FmiVersion) -> Measured:
    point, origin = _of_process(job.item)
    path = built(job, exchange_model(point, origin), contents, version)
    random = np.random.default_rng((job.seed, 2))
    motion, process = point.process.motion, point.process
    held = _random_rows(motion.contents, job.scans, random)
    outside = _random_rows((*process.inputs, *process.disturbances), job.scans, random)
    expected = _by_casadi(point, held, outside)
    names = [signal.name for signal in (*process.inputs, *process.disturbances)]
    found = _by_fmu(path, job.folder / path.stem, held, outside, names)
    shown = [Signal(f"der({signal.name})") for signal in motion.contents]
    return compare(shown, expected + 0.0, found + 0.0), double_bound(job.program), {}


def _of_process(item: ProofItem) -> tuple[OperatingPoint, Origin]:
    if item.point is None:
        raise FmuError(f"{item.name}: a process to be exchanged needs its operating point")
    return item.point, item.origin or Origin(item.name, item.name, "", item.sampling_period)


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


def _by_fmu(
    path: Path, folder: Path, contents: Array, outside: Array, names: Sequence[str]
) -> Array:
    fmpy = importer()
    try:
        description = fmpy.read_model_description(str(path))
        fmpy.extract(str(path), str(folder))
        references = {v.name: v.valueReference for v in description.modelVariables}
        fmu = _started(description, folder)
        size, found = contents.shape[1], np.zeros_like(contents)
        states, rates = (ctypes.c_double * size)(), (ctypes.c_double * size)()
        third = description.fmiVersion == "3.0"
        set_inputs = fmu.setFloat64 if third else fmu.setReal
        derivatives = fmu.getContinuousStateDerivatives if third else fmu.getDerivatives
        known = [references[name] for name in names]
        for k, (row, held) in enumerate(zip(contents.tolist(), outside.tolist(), strict=True)):
            states[:] = row
            set_inputs(known, held)
            fmu.setContinuousStates(states, size)
            derivatives(rates, size)
            found[k] = rates
        fmu.terminate()
        fmu.freeInstance()
    except Exception as error:
        raise FmuError(f"{path.name}: {error}") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return found


def _started(description: Any, folder: Path) -> Any:
    """Return an FMU in continuous-time mode."""
    from fmpy.fmi2 import FMU2Model
    from fmpy.fmi3 import FMU3Model

    third = description.fmiVersion == "3.0"
    fmu = (FMU3Model if third else FMU2Model)(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.modelExchange.modelIdentifier,
        instanceName=description.modelName,
    )
    fmu.instantiate()
    if not third:
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    # The memories stay as they start: only what is asked for in event mode would change them.
    fmu.enterContinuousTimeMode()
    return fmu
