"""What a worker of a cluster does: it takes a job once, and draws chunks of it."""

from __future__ import annotations

import pickle
import zlib
from collections import OrderedDict

import numpy as np

from clepsydra.base.errors import ClepsydraError
from clepsydra.engine.threads import threads_at_most
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.tally import Tally
from clepsydra.studies.robustness.workers_alike import sample

#: Jobs that a worker keeps; those of several users of a cluster come in turns.
_MOST = 4
_jobs: OrderedDict[str, DrawnLoops] = OrderedDict()


class JobMissing(ClepsydraError):
    """A worker that has been started anew, or has had too many others since, lacks a job."""


def take(job: str, packed: bytes, draws: int) -> str:
    """Keep a job of so many draws by its `sample`, and return what that is here."""
    if job in _jobs:
        _jobs.move_to_end(job)
        return job
    loops = pickle.loads(zlib.decompress(packed))
    with threads_at_most(1):
        found = sample(loops, draws)
    if found == job:
        _jobs[job] = loops
    while len(_jobs) > _MOST:
        _jobs.popitem(last=False)
    return found


def draw(job: str, first: int, last: int) -> Tally:
    """Return what came of draws of a job, on one thread.

    Raises
    ------
    JobMissing
        It is to be taken anew.
    """
    loops = _jobs.get(job)
    if loops is None:
        raise JobMissing(job)
    with threads_at_most(1):
        return Tally.of(loops.draw(np.arange(first, last + 1)))
