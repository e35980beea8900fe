"""C in a proof: against the engine, in single precision with what that does to the scores."""

from __future__ import annotations

import math
from typing import Any

from clepsydra.base.errors import InputError
from clepsydra.deploy.c99.printer import CSource
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.proof.comparison import compare, double_bound, is_exact, shown_signals
from clepsydra.deploy.proof.compiled_c import CompiledC, printed_c
from clepsydra.deploy.proof.contents import Contents
from clepsydra.deploy.proof.job import Job
from clepsydra.deploy.proof.limits import OF_SINGLE, PYTHON_LAW
from clepsydra.deploy.proof.run import Measured, Run
from clepsydra.deploy.proof.single_scans import compare_single


def c_runs(kind: str, compiler: Compiler) -> list[Run]:
    """Return what is run of C; of a process in double precision only.

    Examples
    --------
    >>> [run.against for run in c_runs("controller", Compiler(("cc",), "cc 1.0"))]
    ['engine', 'engine in double']
    """
    found = [Run("C", "double", "engine", compiler.version, _printed, _measured)]
    if kind == "controller":
        found.append(
            Run(
                "C",
                "single",
                "engine in double",
                compiler.version,
                printed_single_c,
                _measured_single,
                (PYTHON_LAW, *OF_SINGLE),
                scores=True,
            )
        )
    return found


def printed_single_c(job: Job) -> Contents:
    """Return the C of a job in single precision, and how it is compiled."""
    return _files(job.printed_single_c, job.compiler)


def _printed(job: Job) -> Contents:
    return _files(printed_c(job.program, "double", job.item.origin), job.compiler)


def _files(printed: CSource, compiler: Compiler) -> Contents:
    return {
        printed.header_name: printed.header.encode(),
        printed.source_name: printed.source.encode(),
        "compiler": " ".join([compiler.version, *compiler.flags]).encode(),
    }


def _measured(job: Job, files: Contents) -> Measured:
    name = job.program.name
    printed = CSource(name, files[f"{name}.h"].decode(), files[f"{name}.c"].decode())
    instance = CompiledC(job.program, job.folder / "double", compiler=job.compiler, printed=printed)
    found = compare(shown_signals(job.program), job.engine, instance.run(job.inputs))
    return found, double_bound(job.program), {}


def _measured_single(job: Job, files: Contents) -> Measured:
    if is_exact(job.program):
        wrong = compare(shown_signals(job.program), job.engine_in_single, job.run_of_single_c)
        if wrong.differing:
            return wrong, 0.0, {"against": "engine in single"}
    found, reason = compare_single(job)
    scores = _scores(job)
    said = "; ".join(filter(None, [reason, scores.get("reason")]))
    return found, None, {**scores, "reason": said}


def _scores(job: Job) -> dict[str, Any]:
    """Return what single precision does to the scores, where there is a loop."""
    item = job.item
    if item.controller is None or item.point is None:
        return {}
    from clepsydra.deploy.proof.single_loop import score_change
    from clepsydra.linear.linearise import linearise

    try:
        model = linearise(item.point)
        found = score_change(item.controller, model, item.scenario)
    except InputError as refusal:
        return {"reason": f"the scores were not compared: {refusal}"}
    told = {
        "ranking": _finite(found.ranking),
        "score": found.score,
        "change": _finite(found.change),
        "is_change": found.is_change,
    }
    return {"scores": told}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
