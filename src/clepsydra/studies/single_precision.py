"""What single precision, REAL in a PLC, would do to a controller in the scenario of its study."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.remark import Remark
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.loop.loop import Loop
from clepsydra.studies.ranking import Trial, rank
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.trial import scores_of

if TYPE_CHECKING:
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.loop.run import Run
    from clepsydra.studies.result import Candidate

#: A share of a signal's range, and one of the error that ranks, which an engineer would see.
_SEEN, _WORSE = 0.01, 0.05
_KEEP = "export it in LREAL (double precision)"


def told_of_single_precision(
    ranking: Sequence[Candidate], model: LinearModel, accept: float
) -> tuple[Candidate, ...]:
    """Return a ranking in which the recommended and the best say what REAL would do to them.

    Trouble is one more thing to watch, so that another controller may be recommended; then that
    one is looked at as well.

    Parameters
    ----------
    ranking : sequence of Candidate
        Best first.
    model : LinearModel
        Of the process at the point where the runs start.
    accept : float
        As of `recommend`.
    """
    told, looked_at = list(ranking), set[int]()
    while advice := recommend(told, accept):
        places = {each.rank - 1 for each in (advice.simplest, advice.best)} - looked_at
        if not places:
            break
        looked_at |= places
        for place in places:
            found = single_precision_warnings(told[place], model)
            told[place] = replace(told[place], warnings=(*told[place].warnings, *found))
    return tuple(told)


def single_precision_warnings(candidate: Candidate, model: LinearModel) -> tuple[Remark, ...]:
    """Return what single precision does to a controller; nothing where nobody would see it.

    Its run is repeated with a law that rounds every operation, as the exported one does in REAL.
    Seen is a controlled level or concentration that is off by 1 % of its range at any time, an
    output that is so on average, since a step that comes a sample later moves nothing, or an error
    that is larger or smaller by 5 %.

    Parameters
    ----------
    model : LinearModel
        Of its process at the point where its run starts.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> single_precision_warnings(cl.study(plant, [cl.design.simc(plant)]).best, plant.linear)
    ()
    """
    controller, run = candidate.controller, candidate.run
    if isinstance(controller.law, PythonLaw):
        return ()
    try:
        loop = Loop(controller, model)
        single = loop.run(run.scenario, substeps=run.substeps, precision="single")
    except InputError as refusal:
        seen = f"It has a number that REAL (single precision) has not, {refusal.value}"
        return (Remark(seen, remedy=_KEEP),)
    name, share, words = max(_deviations(run, single), key=lambda found: found[1])
    if share > _SEEN:
        off = f"by {words} {100.0 * share:.2g} % of its range" if share < 1.0 else "by its range"
        seen = f"In REAL (single precision) {name} would be off {off}"
        return (Remark(seen, remedy=_KEEP),)
    times = error_ratio([run, single], [candidate.scores, scores_of(single)])
    if abs(times - 1.0) > _WORSE:
        seen = f"In REAL (single precision) its error would be {times:.3g} times that"
        return (Remark(seen, remedy=_KEEP),)
    return ()


def _deviations(run: Run, single: Run) -> list[tuple[str, float, str]]:
    """Return signals, how far each is off [1] (infinite: it is no number), and in which sense."""
    process = run.process
    found = []
    for name in process.controlled:
        apart = single.true_measurement(name) - run.true_measurement(name)
        found.append((name, float(np.max(np.abs(apart))), "up to"))
    for name in run.controller.manipulated:
        apart = single.values[name] - run.values[name]
        found.append((name, float(np.mean(np.abs(apart))), "on average"))
    return [
        (name, math.inf if math.isnan(apart) else apart / process.signal(name).span, words)
        for name, apart, words in found
    ]


def error_ratio(runs: Sequence[Run], scores: Sequence[dict[str, float]]) -> float:
    """Return the error by which a study ranks, of the second run as a multiple of the first."""
    trials = [
        Trial(run.controller, run, found, maximum_sensitivity=1.0, warnings=())
        for run, found in zip(runs, scores, strict=True)
    ]
    errors = {id(each.run): each.mean_error for each in rank(trials)}
    first, second = (errors[id(run)] for run in runs)
    # A loop that never settles may be infinitely bad in both.
    return 1.0 if first == second else second / first
