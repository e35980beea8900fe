"""A functional mock-up unit: of a controller, or of a process."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.deploy.compiler import Compiler
    from clepsydra.deploy.fmi.model import FmuModel
    from clepsydra.deploy.proof.run import Run
    from clepsydra.linear.operating_point import OperatingPoint


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    """Return the FMU of a controller, for co-simulation."""
    from clepsydra.deploy.fmi.controller import controller_model

    ready = delivery.ready
    name = ready.program.name
    return ExportedFiles(
        {f"{name}.fmu": _fmu(controller_model(ready.program_in_si, ready.origin), options)},
        ready.facts | options,
        f"import {name}.fmu with a communication step of {ready.process.sampling_period:g} s, "
        "which is its time_step; until sensors and modes are set too it stands at fail-safe.",
    )


def _process(point: OperatingPoint, options: Options) -> ExportedFiles:
    """Return the FMUs of a process: for co-simulation, and for model exchange without delays."""
    from clepsydra.deploy.exportable import process_origin
    from clepsydra.deploy.fmi.exchange import exchange_model
    from clepsydra.deploy.fmi.process import process_model
    from clepsydra.deploy.printing.heading import digest
    from clepsydra.deploy.tagged import tagged_point
    from clepsydra.linear.linearise import linearise
    from clepsydra.loop.step_size import substeps_for

    substeps, origin = substeps_for(linearise(point)), process_origin(point)
    point = tagged_point(point)
    model = process_model(point, substeps, origin)
    files = {f"{model.name}.fmu": _fmu(model, options)}
    if point.process.delayed:
        exchange = f"Its {point.process.what_delays} have no form for model exchange."
    else:
        other = exchange_model(point, origin)
        files[f"{other.name}.fmu"] = _fmu(other, options)
        exchange = f"{other.name}.fmu is for model exchange, where the importer integrates."
    return ExportedFiles(
        files,
        {"name": model.name, "digest": digest(model.programs[0]), **options},
        f"import {model.name}.fmu with a communication step of any length; inside, a step has "
        f"{model.step:g} s. {exchange}",
    )


def _fmu(model: FmuModel, options: Options) -> bytes:
    from clepsydra.deploy.compiler import find_compiler
    from clepsydra.deploy.fmi.write import write_fmu

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.fmu"
        write_fmu(path, model, find_compiler(f"FMU of {model.name}"), version=options["fmi"])
        return path.read_bytes()


def _runs(kind: str, compiler: Compiler) -> list[Run]:
    from clepsydra.deploy.proof.fmu_runs import fmu_runs

    return fmu_runs(kind)


TARGETS.add(
    "fmu",
    Target(
        3,
        "a functional mock-up unit",
        _controller,
        {"fmi": ("3.0", "2.0")},
        process=_process,
        runs=_runs,
    ),
)
