"""WebAssembly in a proof: the module that is exported, in every bit what the simulation is."""

from __future__ import annotations

from clepsydra.deploy.proof.called_module import CalledModule
from clepsydra.deploy.proof.comparison import compare, shown_signals
from clepsydra.deploy.proof.job import Contents, Job
from clepsydra.deploy.proof.run import Measured, Run, version_of
from clepsydra.deploy.web_assembly.printer import print_web_assembly


def wasm_runs(kind: str) -> list[Run]:
    """Return what is run of WebAssembly.

    Raises
    ------
    InputError
        Wasmtime is not installed.
    """
    version = version_of("wasmtime")
    return [Run("WebAssembly", "double", "engine", version, _printed, _measured)]


def _printed(job: Job) -> Contents:
    printed = print_web_assembly(job.program, origin=job.item.origin)
    return {printed.module_name: printed.module, printed.script_name: printed.script.encode()}


def _measured(job: Job, files: Contents) -> Measured:
    program = job.program
    instance = CalledModule(program, files[f"{program.name}.wasm"])
    # exp, sin and the like are code of the engine here too: nothing is left to a library.
    return compare(shown_signals(program), job.engine_unfused, instance.run(job.inputs)), 0.0, {}
