"""Single precision where a law magnifies rounding by itself: scan by scan, from equal states."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.deploy.proof.comparison import Difference, compare, shown_signals
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.job import Job
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import signal_of
from clepsydra.program.program import Program

#: Two runs that lie further apart than the range of a signal, as a share of it, have diverged.
DIVERGED = 1.0
#: A simulation that is so many ranges outside of one says nothing of single precision.
_AWAY = 10.0


def compare_single(job: Job) -> tuple[Difference, str]:
    """Compare the C in single precision with the engine in double; returns also what to say of it.

    Both run over the same scans. A law that is unstable by itself (an internal model with a pole
    outside the unit circle, as tuning may make it) magnifies every rounding without a bound,
    since nothing closes the loop here: then two runs in double precision, with inputs that
    differ by the rounding to single, diverge too. Such a law is compared scan by scan, each from
    the state that the engine has before it.

    Examples
    --------
    See `clepsydra.deploy.proof.run`.
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
