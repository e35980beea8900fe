"""C in a proof: against the engine, in single precision with what that does to the scores."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.deploy.c99.printer import CSource
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.proof.comparison import (
    DIVERGED,
    Difference,
    compare,
    double_bound,
    is_exact,
    shown_signals,
)
from clepsydra.deploy.proof.compiled_c import CompiledC, printed_c
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.job import Contents, Job
from clepsydra.deploy.proof.limits import OF_SINGLE, PYTHON_LAW
from clepsydra.deploy.proof.run import Measured, Run
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program

#: A simulation that is so many ranges outside of one says nothing of single precision.
_AWAY = 10.0


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
    found, reason = _compare_single(job)
    scores = _scores(job)
    said = "; ".join(filter(None, [reason, scores.get("reason")]))
    return found, None, {**scores, "reason": said}


def _scores(job: Job) -> dict[str, Any]:
    """Return what single precision does to the scores, where there is a loop."""
    from clepsydra.deploy.proof.single_loop import score_change
    from clepsydra.linear.linearise import linearise

    item = job.item
    if item.controller is None or item.point is None:
        return {}
    try:
        model = linearise(item.point)
        return {"scores": score_change(item.controller, model, item.scenario)}
    except InputError as refusal:
        return {"reason": f"the scores were not compared: {refusal}"}


def _compare_single(job: Job) -> tuple[Difference, str]:
    """Compare the C in single precision with the engine in double; returns also what to say of it.

    Both run over the same scans. A law that is unstable by itself (an internal model with a pole
    outside the unit circle, as tuning may make it) magnifies every rounding without a bound,
    since nothing closes the loop here: then two runs in double precision, with inputs that
    differ by the rounding to single, diverge too. Such a law is compared scan by scan, each from
    the state that the engine has before it.
    """
    program = job.program
    found = compare(shown_signals(program), job.engine_of_single, job.run_of_single_c)
    if found.largest <= DIVERGED or program.rings:
        return found, ""
    rounded = engine_run(program, {name: _rounded(job, name) for name in job.inputs})
    if compare(shown_signals(program), job.engine, rounded).largest <= DIVERGED:
        return found, ""
    near = _near(program, job.engine_of_single)
    scans = _from_equal_states(job, near)
    return compare(shown_signals(program), job.engine_of_single, scans), (
        "by itself, with no process to close the loop, the law magnifies every rounding, in double "
        f"precision too: compared are {int(near.sum()):,} single scans, each from the state of the "
        "simulation, where that is within ten times its ranges"
    )


def _rounded(job: Job, name: str) -> Array:
    """Return an input rounded to single precision where that can hold its size."""
    single, double = job.single_inputs[name], job.inputs[name]
    return np.where(np.isinf(single), double, single)


def _near(program: Program, table: Array) -> np.ndarray:
    """Return in which scans the simulation is not far outside of its ranges, before and after."""
    inside = np.ones(len(table), dtype=bool)
    for column, signal in enumerate(shown_signals(program)):
        if math.isfinite(signal.span):
            away = _AWAY * signal.span
            values = table[:, column]
            inside &= (values >= signal.low - away) & (values <= signal.high + away)
    return inside & np.concatenate([[True], inside[:-1]])


def _from_equal_states(job: Job, compared: np.ndarray) -> Array:
    """Return outputs and states of the C after single scans; those of the engine elsewhere."""
    program, engine = job.program, job.engine_of_single
    states = engine[:, len(program.outputs) :]
    start = [[signal_of(entry).initial for entry in program.state]]
    ran = job.single_c.scan_by_scan(np.concatenate([start, states[:-1]]), job.single_inputs)
    found = engine.copy()
    for column in range(engine.shape[1]):
        place = column - len(program.outputs)
        entry = program.state[place] if place >= 0 else None
        # What goes into a ring is what the engine shows of it when it comes out.
        later = entry.length - 1 if isinstance(entry, DelayRing) else 0
        kept = np.flatnonzero(compared[: len(compared) - later])
        found[kept + later, column] = ran[kept, column]
    return found
