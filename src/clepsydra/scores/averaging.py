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

from clepsydra.scores.sample import Expression, Fold, Sample, magnitude
from clepsydra.scores.score import Of, Ranks, Score
from clepsydra.scores.trajectory import FloatArray, finite_or_infinite

_SECONDS_PER_HOUR = 3600.0


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
