"""What a run costs, weighed before it begins."""

from __future__ import annotations

import functools
import logging

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.loop.step_size import MOST_SUBSTEPS, Solver
from clepsydra.process.process import Process

#: A state takes about so long for an integration step of the kernel, and a whole process for one
#: of the reference solver, which are sampling periods where nothing is delayed [s].
_STATE_STEP, _REFERENCE_STEP = 1e-7, 3e-4
#: A run that takes longer is told of, and one that takes much longer refused [s].
_TOLD, LONGEST_RUN = 20.0, 3600.0
#: With steps of h, h/2 and h/4 a run is made, so that its error is known.
_CHECKED = 1 + 2 + 4
_LOG = logging.getLogger(__name__)


def run_cost(
    process: Process, samples: int, substeps: int, *, checked: bool, solver: Solver = "kernel"
) -> float:
    """Return about how long a run takes [s], on a processor of today.

    Examples
    --------
    Four states, 4260 samples of one step, thrice for its error:

    >>> from clepsydra.process.reader import load_process
    >>> round(run_cost(load_process("quadruple-tank"), 4260, 1, checked=True), 3)
    0.012
    """
    if solver == "reference":
        return _REFERENCE_STEP * samples * (substeps if process.motion.delays else 1)
    steps = _CHECKED * min(substeps, MOST_SUBSTEPS // 4) if checked else substeps
    return _STATE_STEP * len(process.state) * samples * steps


def weigh_run(
    process: Process,
    samples: int,
    substeps: int,
    *,
    checked: bool = True,
    solver: Solver = "kernel",
) -> None:
    """Say once in the log what a long run will cost; refuse one of more than an hour.

    Parameters
    ----------
    substeps : int
        Integration steps in a sampling period.
    checked : bool
        Whether the steps are halved until the error is known.

    Raises
    ------
    InputError
        It would take more than an hour.
    """
    cost = run_cost(process, samples, substeps, checked=checked, solver=solver)
    step = process.sampling_period / substeps
    what = f"{samples:,} samples of {substeps:,} integration steps, about {time_text(cost, 2)}"
    if cost > LONGEST_RUN:
        raise InputError(
            f"{process.name}, run", what,
            f"a run of at most {time_text(LONGEST_RUN)}; its fastest time constant asks for steps "
            f"of {step:.3g} s",
            "shorten the scenario, lengthen the sampling period where the steps are of its length, "
            "or leave out what settles so fast: a vessel that is nearly empty, or very small",
        )  # fmt: skip
    if cost > _TOLD:
        _tell(f"{process.name}: each run has {what}: its fastest time constant asks for steps of "
              f"{step:.3g} s")  # fmt: skip


@functools.cache
def _tell(words: str) -> None:
    _LOG.warning("%s", words)
