"""FMUs as targets of a proof: co-simulation against the engine."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.proof.comparison import Difference, compare, double_bound
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.imported_fmu import FmuError, ImportedFmu
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.job import Job
from clepsydra.program.entries import is_ring

if TYPE_CHECKING:
    from clepsydra.deploy.fmi.model import FmuModel
    from clepsydra.deploy.fmi.write import FmiVersion

Measured = tuple[Difference, float | None, dict[str, Any]]


def co_simulation(version: FmiVersion) -> Callable[[Job, Contents], Measured]:
    """Return what measures an FMU for co-simulation of a version of the interface.

    It takes a job and what the FMU has to hold, see `co_simulation_contents`.

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
    ...     job = Job(item, 100, 1, Path(folder), find_compiler("example"))
    ...     difference, bound, _ = co_simulation("3.0")(job, co_simulation_contents("3.0")(job))
    >>> difference.differing, bound
    (0, 0.0)
    """

    def measure(job: Job, contents: Contents) -> Measured:
        from clepsydra.deploy.fmi.write import write_fmu

        job.folder.mkdir(parents=True, exist_ok=True)
        path = job.folder / f"{job.program.name}-{version}.fmu"
        write_fmu(path, model_of(job.item), job.compiler, version=version)
        check_contents(path, contents)
        with ImportedFmu(
            job.program, path, job.folder / path.stem, job.item.sampling_period
        ) as instance:
            found = instance.run(job.inputs)
            shown = instance.shown
        # A delay ring is no variable of an FMU.
        kept = [True] * len(job.program.outputs) + [not is_ring(e) for e in job.program.state]
        difference = compare(shown, job.engine[:, np.array(kept, dtype=bool)], found)
        return difference, double_bound(job.program), {}

    return measure


def co_simulation_contents(version: FmiVersion) -> Callable[[Job], Contents]:
    """Return what prints the files of an FMU for co-simulation, all but its binary.

    Examples
    --------
    See `co_simulation`.
    """

    def contents(job: Job) -> Contents:
        from clepsydra.deploy.fmi.write import fmu_contents

        return fmu_contents(model_of(job.item), version)

    return contents


def check_contents(path: Path, contents: Contents) -> None:
    """Refuse an FMU that holds other files than those told, but for its binary.

    Raises
    ------
    FmuError

    Examples
    --------
    See `co_simulation`.
    """
    with zipfile.ZipFile(path) as archive:
        held = {n: archive.read(n) for n in archive.namelist() if not n.startswith("binaries/")}
    if held != dict(contents):
        raise FmuError(f"{path.name}: it holds other files than were printed")


def model_of(item: ProofItem) -> FmuModel:
    """Return the model for co-simulation of a controller or a process.

    Examples
    --------
    See `co_simulation`.
    """
    from clepsydra.deploy.fmi.controller import controller_model
    from clepsydra.deploy.fmi.process import process_model
    from clepsydra.linear.linearise import linearise
    from clepsydra.loop.step_size import substeps_for

    origin = item.origin or Origin(item.name, "a process", "", item.sampling_period)
    if item.kind == "process" and item.point is not None:
        return process_model(item.point, substeps_for(linearise(item.point)), origin)
    assert item.program is not None
    return controller_model(item.program, origin)
