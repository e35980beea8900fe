"""Scores of averaging control: a tank that lets its level move, so that its outflow moves less.

They look at the flows while a load acts. Flows are held during a sample.

The largest rate of change is that of T.-F. Cheung and W. L. Luyben, Liquid-level control in single
tanks and cascades of tanks with proportional-only and proportional-integral feedback controllers,
Industrial & Engineering Chemistry Fundamentals 18(1), 1979, pages 15–21. The variance ratio is
ours, after K. A. McDonald, T. J. McAvoy and A. Tits, Optimal averaging level control, AIChE Journal
32(1), 1986, pages 75–86, who filter the flow alike.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.scores.effort import turns
from clepsydra.scores.load_response import LAST_SHARE
from clepsydra.scores.sample import Expression, Fold, Sample, magnitude
from clepsydra.scores.score import Of, Ranks, Score
from clepsydra.scores.trajectory import FloatArray, finite_or_infinite

_SECONDS_PER_HOUR = 3600.0
#: What of the largest inflow counts as no change of it, a share; and what a turn of the outflow
#: must come back by to count, a share of that change.
_NO_CHANGE, _TURN = 1e-6, 0.02


def rate_of_change(sample: Sample) -> Expression:
    """Return how fast the outflow moves into the sample that begins now [m³/h per h]."""
    flow = sample.outflow
    return sample.load * magnitude(flow.now - flow.before) * (_SECONDS_PER_HOUR**2 / sample.period)


def variances(sample: Sample) -> tuple[Expression, ...]:
    """Return the shares of the sample that begins now in the variances of out- and inflow."""
    changes = [flow.now - flow.base for flow in (sample.outflow, sample.inflow)]
    return tuple(sample.load * sample.held * change * change for change in changes)


def ratio(leaving: FloatArray, arriving: FloatArray) -> FloatArray:
    """Return a variance ratio; not a number where no load changes the inflow.

    0 is perfect smoothing; 1 is none, as if the tank were a pipe; above 1 the controller makes it
    worse. A step that stays is passed on sooner or later by every controller that brings the level
    back; the ratio then says how soon.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.asarray(arriving) > 0.0, np.divide(leaving, arriving), np.nan)


@finite_or_infinite
def volume_used(
    time: FloatArray, filling: FloatArray, loads: Sequence[slice] = (slice(None),)
) -> float:
    """Return the share of the tank between lowest and highest level while loads act [%].

    A small one means that the tank could smooth more than its controller lets it.

    The filling is volume over capacity [n], the loads are the samples in which each acts.

    Examples
    --------
    >>> volume_used([0.0, 1.0, 2.0], [0.5, 0.75, 0.25])
    50.0
    """
    acting = np.concatenate([filling[load] for load in loads])
    return 100.0 * float(np.max(acting) - np.min(acting))


def _changes(inflow: FloatArray, outflow: FloatArray, load: slice) -> tuple[FloatArray, float]:
    """Return the outflow since before a load [n], in units of what the inflow changes by at last.

    Also that change [m³/s]; 0 where the load does not reach the tank.
    """
    before = max(load.start - 1, 0)
    late = inflow[load][-max(1, round(LAST_SHARE * (load.stop - load.start))) :]
    change = float(np.mean(late) - inflow[before])
    if abs(change) <= _NO_CHANGE * max(float(np.max(np.abs(inflow))), 1e-300):
        return np.zeros(0), 0.0
    return (outflow[load] - outflow[before]) / change, change


@finite_or_infinite
def outflow_overshoot(
    time: FloatArray, outflow: FloatArray, inflow: FloatArray, loads: Sequence[slice]
) -> float:
    """Return how far the outflow goes beyond a changed inflow, in the worst load step [%].

    In per cent of what the inflow changes by. A level that has risen can only come back while more
    leaves than arrives, so that it is never 0 for a controller that brings it back.

    Examples
    --------
    >>> flows = np.array([4.0, 4.0, 6.5, 6.0]), np.array([4.0, 6.0, 6.0, 6.0])
    >>> outflow_overshoot(np.arange(4.0), *flows, [slice(1, 4)])
    25.0
    """
    found = [_changes(inflow, outflow, load)[0] for load in loads]
    return 100.0 * max((float(np.max(each)) - 1.0 for each in found if each.size), default=0.0)


@finite_or_infinite
def swings(
    time: FloatArray, outflow: FloatArray, inflow: FloatArray, loads: Sequence[slice]
) -> float:
    """Return how often the outflow turns after a load step, in the worst one.

    A turn counts once it has come back by more than 2 % of what the inflow changes by.

    Examples
    --------
    >>> flows = np.array([4.0, 4.0, 6.5, 5.8, 6.01]), np.array([4.0, 6.0, 6.0, 6.0, 6.0])
    >>> swings(np.arange(5.0), *flows, [slice(1, 5)])
    2.0
    """
    found = [_changes(inflow, outflow, load)[0] for load in loads]
    return float(max((turns(each, _TURN) for each in found if each.size), default=0))


Score(
    "outflow_rate",
    "Outflow, fastest change",
    "Largest rate of change, from sample to sample, of what leaves the tank, during load steps.",
    Of.AVERAGING,
    unit="m³/h per h",
    ranks=Ranks.AVERAGING,
    negligible=1e-9,
    phrase="outflow change",
    wants="load",
    integrand=rate_of_change,
    fold=Fold.LARGEST,
).registered()
Score(
    "variance_ratio",
    "Outflow, variance ratio",
    "Mean square of the change of the outflow since before a load step, over that of the "
    "inflow: 0 smooths all, 1 nothing.",
    Of.AVERAGING,
    unit="1",
    ranks=Ranks.AVERAGING_FREELY,
    negligible=1e-6,
    phrase="outflow variance",
    wants="load",
    integrand=variances,
    fold=Fold.SUM,
    finish=ratio,
).registered()
Score(
    "outflow_overshoot",
    "Outflow, overshoot",
    "How far the outflow goes beyond the inflow after a load step, in per cent of what the inflow "
    "changed by, in the worst one.",
    Of.AVERAGING,
    unit="% of the step",
    negligible=0.1,
    wants="load",
    over=lambda run, name: outflow_overshoot(
        run.time, run.plant.buffers[name].outflow, run.plant.buffers[name].inflow, run.loads
    ),
).registered()
Score(
    "outflow_swings",
    "Outflow, swings",
    "How often the outflow turns and comes back by more than 2 % of what the inflow changed by, "
    "after the worst load step.",
    Of.AVERAGING,
    unit="1",
    wants="load",
    over=lambda run, name: swings(
        run.time, run.plant.buffers[name].outflow, run.plant.buffers[name].inflow, run.loads
    ),
).registered()
Score(
    "volume_used",
    "Volume used",
    "Share of the tank between its lowest and its highest level during load steps; a small "
    "one leaves smoothing unused.",
    Of.AVERAGING,
    unit="% of the tank",
    negligible=0.1,
    smaller_is_better=False,
    wants="load",
    over=lambda run, name: volume_used(run.time, run.plant.buffers[name].filling, run.loads),
).registered()
