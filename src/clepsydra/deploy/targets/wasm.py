"""WebAssembly: a module, and a script that runs it in a browser or in Node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.deploy.compiler import Compiler
    from clepsydra.deploy.proof.run import Run
    from clepsydra.deploy.web_assembly.printer import WebModule
    from clepsydra.linear.operating_point import OperatingPoint


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    from clepsydra.deploy.web_assembly.printer import print_web_assembly

    ready = delivery.ready
    printed = print_web_assembly(ready.program, origin=ready.origin)
    return ExportedFiles(
        _files(printed),
        ready.facts | options,
        f"import instantiate from {printed.script_name}, give it the content of "
        f"{printed.module_name}, set its inputs and call step every "
        f"{ready.process.sampling_period:g} s.",
    )


def _process(point: OperatingPoint, options: Options) -> ExportedFiles:
    """Return the module of a process: one sampling period a step."""
    from clepsydra.deploy.exportable import process_origin
    from clepsydra.deploy.printing.heading import digest
    from clepsydra.deploy.process_program import process_program
    from clepsydra.deploy.tagged import tagged_point
    from clepsydra.deploy.web_assembly.printer import print_web_assembly

    tagged = tagged_point(point)
    program = process_program(tagged)
    printed = print_web_assembly(program, origin=process_origin(point))
    return ExportedFiles(
        _files(printed),
        {"name": program.name, "digest": digest(program), **options},
        f"import instantiate from {printed.script_name}, give it the content of "
        f"{printed.module_name}, set its inputs and call step, which "
        f"advances it by {point.process.sampling_period:g} s.",
    )


def _files(printed: WebModule) -> dict[str, bytes]:
    return {printed.module_name: printed.module, printed.script_name: printed.script.encode()}


def _runs(kind: str, compiler: Compiler) -> list[Run]:
    from clepsydra.deploy.proof.wasm_runs import wasm_runs

    return wasm_runs(kind)


TARGETS.add(
    "wasm",
    Target(4, "WebAssembly for a browser", _controller, process=_process, runs=_runs),
)
