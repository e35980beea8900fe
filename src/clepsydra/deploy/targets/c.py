"""C99: a header and a source."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.deploy.compiler import Compiler
    from clepsydra.deploy.proof.run import Run


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    from clepsydra.deploy.c99.printer import print_c

    ready, precision = delivery.ready, options["precision"]
    printed = print_c(ready.program, origin=ready.origin, precision=precision)
    name = ready.program.name
    return ExportedFiles(
        {
            printed.header_name: printed.header.encode(),
            printed.source_name: printed.source.encode(),
        },
        ready.facts | options,
        f"compile {printed.source_name}; call {name}_initialise, {name}_default_parameters and "
        f"{name}_default_inputs once and {name}_step every "
        f"{ready.process.sampling_period:g} s.",
    )


def _runs(kind: str, compiler: Compiler) -> list[Run]:
    from clepsydra.deploy.proof.c_runs import c_runs

    return c_runs(kind, compiler)


TARGETS.add("c", Target(1, "C99", _controller, {"precision": ("double", "single")}, runs=_runs))
