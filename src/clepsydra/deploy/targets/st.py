"""IEC 61131-3 Structured Text: a function block, and a project that runs it against the tank."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from clepsydra.deploy.target import TARGETS, Delivery, ExportedFiles, Options, Target

if TYPE_CHECKING:
    from clepsydra.deploy.compiler import Compiler
    from clepsydra.deploy.exportable import Exportable
    from clepsydra.deploy.proof.run import Run
    from clepsydra.deploy.structured_text.loop_program import Beside
    from clepsydra.program.program import Program

#: How the test project comes into the editors of each dialect, and runs.
_IMPORT = {
    "codesys": "import {test}.xml (Project → Import PLCopenXML; in TwinCAT on the PLC project), "
    "and call {test} in a cyclic task of {period}.",
    "matiec": "upload {test}.st to the OpenPLC Runtime (Programs), which finds its task of "
    "{period} in it; an editor opens {test}.xml under the name plc.xml.",
    "scl": "add {test}.scl (External source files → Add new external file), generate blocks from "
    "it, and call {test} in a cyclic interrupt of {period}.",
}


def _controller(delivery: Delivery, options: Options) -> ExportedFiles:
    """Return NAME.st or NAME.scl with the function block, and the test project.

    That is NAME_test.st with block, tank and the program that runs both, and but for scl
    NAME_test.xml, the same as PLCopen XML. A tank with a number that REAL cannot hold is left out.
    """
    from clepsydra.base.errors import InputError
    from clepsydra.deploy.process_program import process_program
    from clepsydra.deploy.structured_text.dialect import dialect_of
    from clepsydra.deploy.structured_text.printer import print_structured_text
    from clepsydra.deploy.structured_text.time_literal import time_literal
    from clepsydra.deploy.tagged import tagged_point

    ready, dialect = delivery.ready, options["dialect"]
    name, ending = ready.program.name, "scl" if dialect == "scl" else "st"
    period = time_literal(ready.process.sampling_period)  # refuses what no task can hold
    rules = replace(dialect_of(dialect).names, language=f"Structured Text, {dialect}", longest=0)
    for signal, tag in ready.process.tags.items():
        rules.check(tag, f"{ready.process.address}, tag of {signal}")
    texts = {
        f"{name}.{ending}": print_structured_text(ready.program, origin=ready.origin, **options)
    }
    steps = []
    if ready.controller.manipulated:
        tank = process_program(tagged_point(ready.point))
        try:
            print_structured_text(tank, **options)
        except InputError as refusal:
            steps = [f"there is no test project, since the tank cannot be printed: {refusal}"]
        else:
            projects = _test_projects(delivery, tank, options)
            texts |= {f"{name}_test.{kind}": text for kind, text in projects.items()}
            steps = [
                _IMPORT[dialect].format(test=f"{name}_test", period=period),
                "Run it in the PLC's simulator first: its controller drives a simulated tank.",
            ]
    steps.append(f"For the plant take {name}.{ending} alone, wired, in a task of {period}.")
    # TIA Portal takes a text without a byte order mark for one of the machine's code page.
    encoding = "utf-8-sig" if dialect == "scl" else "utf-8"
    files = {file: text.encode(encoding) for file, text in texts.items()}
    return ExportedFiles(files, ready.facts | options, steps[0], tuple(steps[1:]))


def _test_projects(delivery: Delivery, tank: Program, options: Options) -> dict[str, str]:
    """Return the project that runs a controller against its tank, by the ending of its file."""
    from clepsydra.deploy.exportable import process_origin
    from clepsydra.deploy.plcopen.printer import print_plcopen_project
    from clepsydra.deploy.structured_text.project import Project, print_test_project

    ready = delivery.ready
    project = Project(
        ready.program,
        tank,
        ready.wires,
        ready.process.sampling_period,
        ready.origin,
        process_origin(ready.point),
        alarms=_beside(ready) if ready.process.alarms else None,
        **options,
    )
    if options["dialect"] == "scl":  # TIA Portal reads no PLCopen XML
        return {"scl": print_test_project(project)}
    return {"st": print_test_project(project), "xml": print_plcopen_project(project)}


def _beside(ready: Exportable) -> Beside:
    """Return the alarms of the process, to stand beside the controller."""
    from clepsydra.deploy.exported_alarms import exportable_alarms
    from clepsydra.deploy.structured_text.loop_program import Beside

    alarms = exportable_alarms(ready.point)
    return Beside(alarms.program, alarms.wires, alarms.origin)


def _runs(kind: str, compiler: Compiler) -> list[Run]:
    from clepsydra.deploy.proof.interpreted_text import text_runs

    return text_runs(kind)


TARGETS.add(
    "st",
    Target(
        2,
        "IEC 61131-3 Structured Text with a test project (PLCopen XML but for scl)",
        _controller,
        {"precision": ("double", "single"), "dialect": ("codesys", "matiec", "scl")},
        runs=_runs,
    ),
)
