"""FMUs for co-simulation in a proof: against the engine."""

from __future__ import annotations

import zipfile
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np

from clepsydra.deploy.fmi.controller import controller_model
from clepsydra.deploy.fmi.model import FmuModel
from clepsydra.deploy.fmi.process import process_model
from clepsydra.deploy.fmi.write import FmiVersion, fmu_contents, write_fmu
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.comparison import compare, double_bound
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.imported_fmu import FmuError, ImportedFmu
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.linear.linearise import linearise
from clepsydra.loop.step_size import substeps_for
from clepsydra.program.entries import is_ring


def fmu_runs() -> list[Run]:
    """Return what is run of FMUs for co-simulation, one for each version of the interface.

    Raises
    ------
    InputError
        The importer is missing.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.deploy.compiler import find_compiler
    >>> from clepsydra.program.program import Block, Operation, Program
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("u"),), (), (Signal("y"),), double)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     item = ProofItem("doubled", 1.0, program)
    ...     job, run = Job(item, 100, 1, Path(folder), find_compiler("example")), fmu_runs()[0]
    ...     difference, bound, _ = run.measure(job, run.printed(job))
    >>> difference.differing, bound
    (0, 0.0)
    """
    importer = version_of("FMPy")
    return [
        Run(
            f"FMU {version}",
            "double",
            "engine",
            importer,
            partial(_printed, version=version),
            partial(_measured, version=version),
            in_si=True,
        )
        for version in get_args(FmiVersion)
    ]


def _printed(job: Job, version: FmiVersion) -> Contents:
    """Return the files of an FMU for co-simulation, all but its binary."""
    return fmu_contents(model_of(job.item), version)


def _measured(job: Job, contents: Contents, version: FmiVersion) -> Measured:
    path = built(job, model_of(job.item), contents, version)
    with ImportedFmu(
        job.program, path, job.folder / path.stem, job.item.sampling_period
    ) as instance:
        found = instance.run(job.inputs)
        shown = instance.shown
    # A delay ring is no variable of an FMU.
    kept = [True] * len(job.program.outputs) + [not is_ring(e) for e in job.program.state]
    difference = compare(shown, job.engine[:, np.array(kept, dtype=bool)], found)
    return difference, double_bound(job.program), {}


def built(job: Job, model: FmuModel, contents: Contents, version: FmiVersion) -> Path:
    """Build the FMU of a model, and refuse it where it holds other files than were printed.

    Raises
    ------
    FmuError

    Examples
    --------
    See `fmu_runs`.
    """
    job.folder.mkdir(parents=True, exist_ok=True)
    path = job.folder / f"{model.name}-{version}.fmu"
    write_fmu(path, model, job.compiler, version=version)
    with zipfile.ZipFile(path) as archive:
        held = {n: archive.read(n) for n in archive.namelist() if not n.startswith("binaries/")}
    if held != dict(contents):
        raise FmuError(f"{path.name}: it holds other files than were printed")
    return path


def model_of(item: ProofItem) -> FmuModel:
    """Return the model for co-simulation of a controller or a process.

    Examples
    --------
    See `fmu_runs`.
    """
    origin = item.origin or Origin(item.name, "a process", "", item.sampling_period)
    if item.kind == "process" and item.point is not None:
        return process_model(item.point, substeps_for(linearise(item.point)), origin)
    assert item.program is not None
    return controller_model(item.program, origin)
