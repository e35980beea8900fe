"""What came of each draw: the scores of every event and of the whole run, and what happened."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from clepsydra.linear.equilibria import Equilibria
from clepsydra.loop.finite_span import finite_span
from clepsydra.loop.lane_status import LaneStatus
from clepsydra.loop.loop_batch import BatchRun, LoopBatch
from clepsydra.process.process import Process
from clepsydra.scores.segment import Segment

Array = NDArray[np.float64]
Truths = NDArray[np.bool_]

#: A mean error over the last tenth of an event counts from this share of the measurement's range:
#: a twentieth of a step of a default scenario.
STEADY_ERROR = 0.005
#: A measurement swings from this share of its range on, over the second half of an event, ...
_SWING = 0.01
#: ... if each way takes it so far to its side of the setpoint, as a share of the whole swing.
_EACH_WAY = 0.25
#: Parts of an event that is judged, see `clepsydra.loop.stretches`.
_PARTS = 3
#: What is judged of every controlled measurement beside what is asked.
_JUDGED = ("error_integral", "highest_error", "lowest_error")


class Happening(StrEnum):
    """What can happen in a draw that is no score."""

    INFEASIBLE = "no admissible steady state"
    OVERFLOW = "a tank spills"
    DRY = "a tank runs empty"
    HARM = "the plant is harmed"
    UNSTABLE = "the loop does not settle"
    STEADY = "an error stays"
    UNSOLVED = "too fast to be simulated"


@dataclass(frozen=True, eq=False)
class DrawnScores:
    """What came of some draws.

    Parameters
    ----------
    numbers : ndarray of int [draws]
    scores : dict
        Score to its value in each event, the whole run first [1 + events, draws]; infinite where
        the loop broke, not a number where a draw has no admissible steady state.
    happened : dict
        What happened, or not [draws].
    reason : ndarray of int [draws]
        Place in `reasons` of why a draw has no admissible steady state; -1 where it has one.
    reasons : tuple of str
    substeps : ndarray of int [draws]
        Integration steps in a sampling period; 0 of a draw that was not simulated.
    """

    numbers: NDArray[np.int64]
    scores: dict[str, Array]
    happened: dict[Happening, Truths]
    reason: NDArray[np.int64]
    reasons: tuple[str, ...]
    substeps: NDArray[np.int64]


def judged_names(process: Process) -> tuple[str, ...]:
    """Return the running scores from which it is told whether a loop settles, and where."""
    return tuple(f"{key}[{y}]" for y in process.controlled for key in _JUDGED)


def events_of(batch: LoopBatch) -> tuple[Segment | None, ...]:
    """Return what happens in each stretch of a batch."""
    return tuple(stretch.segment for stretch in batch.stretches)


def drawn_scores(
    batch: LoopBatch,
    names: Sequence[str],
    numbers: NDArray[np.int64],
    rest: Equilibria,
    run: BatchRun,
) -> DrawnScores:
    """Return what came of some draws.

    Parameters
    ----------
    batch : LoopBatch
        With the scores asked for and those of `judged_names`.
    names : sequence of str
        The scores asked for.
    numbers : ndarray of int [draws]
    rest : Equilibria
        Where each begins.
    run : BatchRun
        Of those that have a steady state.
    """
    feasible = rest.feasible
    scores = {}
    for name in names:
        values = batch.scores_of(run, name)
        scores[name] = np.full((len(values), len(numbers)), np.nan)
        scores[name][:, feasible] = values
    happened = {Happening.INFEASIBLE: ~feasible}
    for what, found in happened_in(batch, run).items():
        happened[what] = np.zeros(len(numbers), bool)
        happened[what][feasible] = found
    substeps = np.zeros(len(numbers), np.int64)
    substeps[feasible] = run.substeps
    return DrawnScores(numbers, scores, happened, rest.reason, rest.reasons, substeps)


def happened_in(batch: LoopBatch, run: BatchRun) -> dict[Happening, Truths]:
    """Return what happened in a run, or not [plants], of all that can happen in one.

    Parameters
    ----------
    batch : LoopBatch
        With the scores of `judged_names`.
    run : BatchRun
    """
    return {
        Happening.OVERFLOW: (run.status & LaneStatus.SPILLING) != 0,
        Happening.DRY: (run.status & LaneStatus.EMPTIED) != 0,
        Happening.HARM: (run.status & LaneStatus.HARMED) != 0,
        Happening.UNSOLVED: (run.status & LaneStatus.STEP_TOO_LONG) != 0,
        Happening.UNSTABLE: _unsettled(batch, run),
        Happening.STEADY: _off(batch, run),
    }


def joined(parts: Sequence[DrawnScores]) -> DrawnScores:
    """Return what came of the draws of several parts, one after the other."""
    first = parts[0]
    return DrawnScores(
        np.concatenate([each.numbers for each in parts]),
        {n: np.concatenate([each.scores[n] for each in parts], axis=1) for n in first.scores},
        {w: np.concatenate([each.happened[w] for each in parts]) for w in first.happened},
        np.concatenate([each.reason for each in parts]),
        first.reasons,
        np.concatenate([each.substeps for each in parts]),
    )


def _unsettled(batch: LoopBatch, run: BatchRun) -> Truths:
    """Tell where a run broke, or an output swings about its setpoint as an event ends."""
    found, process = run.broken(), batch.loop.process
    for y in process.controlled:
        span = finite_span(process, process.signal(y))
        for part in _second_halves(batch):
            high = run.folds[f"highest_error[{y}]"][part].max(axis=0)
            low = run.folds[f"lowest_error[{y}]"][part].min(axis=0)
            swing = high - low
            both = np.minimum(high, -low) > _EACH_WAY * swing
            found |= (swing > _SWING * span) & both
    return found


def _off(batch: LoopBatch, run: BatchRun) -> Truths:
    """Tell where an output has a mean error over the last tenth of an event."""
    found, process = run.broken(), batch.loop.process
    period, ends = process.sampling_period, list(_ends(batch))
    for y in process.controlled:
        span = finite_span(process, process.signal(y))
        for part, samples in ends:
            error = run.folds[f"error_integral[{y}]"][part] / (samples * period)
            found |= np.abs(error) > STEADY_ERROR * span
    return found


def _second_halves(batch: LoopBatch) -> Iterator[slice]:
    """Yield the parts of a run that are the second half of an event."""
    first = 0
    for stretch in batch.stretches:
        parts = len(stretch.parts) - 1
        if parts == _PARTS:
            yield slice(first + 1, first + parts)
        first += parts


def _ends(batch: LoopBatch) -> Iterator[tuple[int, int]]:
    """Yield the part that is the last tenth of an event, and its samples."""
    first = 0
    for stretch in batch.stretches:
        parts = len(stretch.parts) - 1
        if parts == _PARTS:
            yield first + parts - 1, stretch.parts[-1] - stretch.parts[-2]
        first += parts
