"""The first controllers of a study on drawn plants, and what that does to their order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from clepsydra.controllers.python_law import PythonLaw
from clepsydra.studies.ranking import in_order
from clepsydra.studies.result import Candidate, DrawnError, Standing, StudyResult
from clepsydra.studies.robustness.campaign import DrawProgress
from clepsydra.studies.robustness.drawn_loops import DrawnLoops, mean_error
from clepsydra.studies.robustness.drawn_plants import DrawnPlants
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.robustness.robustness import usual_names, yardstick_of

#: Of the ranking, and plants that each of them meets.
FIRST, DRAWS = 5, 64
#: Operations of a controller on all of these plants, beyond which it is left out: a nonlinear
#: predictive controller would take longer than its whole study.
_MOST = 4e10
#: What is no fault of a controller where it happens on paper too.
_UNSTABLE = (Happening.UNSTABLE, Happening.HARM)


def with_draws(
    result: StudyResult,
    draws: int = DRAWS,
    progress: Callable[[DrawProgress], None] | None = None,
) -> StudyResult:
    """Return a study whose first controllers have met drawn plants.

    One that does not settle on some of them, or harms the plant, while it does neither on paper, is
    no longer robust: it goes behind those that are, and who follows is drawn in its place.

    Parameters
    ----------
    draws : int
        Plants, the same for every controller.
    progress : callable, optional
        Takes how far it is, after each controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = with_draws(cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)]))
    >>> [each.drawn.draws for each in found.ranking], found.ranking[0].drawn.worst > 1.0
    ([64, 64], True)
    """
    ranking = result.ranking
    plants = DrawnPlants(
        result.point, result.analysis.pairing, result.process.uncertainty, result.scenario.seed
    )
    while True:
        left = [each for each in ranking[:FIRST] if each.drawn is None]
        if not left:
            return replace(result, ranking=ranking)
        for candidate in left:
            met = _met(result, plants, candidate, draws)
            standing = (
                max(candidate.standing, Standing.STABLE) if met.unsettled else candidate.standing
            )
            drawn = replace(candidate, drawn=met, standing=standing)
            ranking = tuple(drawn if each is candidate else each for each in ranking)
            if progress is not None:
                done = sum(each.drawn is not None for each in ranking)
                progress(DrawProgress(done, max(done, min(FIRST, len(ranking))), np.inf))
        ranking = in_order(ranking)


def _met(result: StudyResult, plants: DrawnPlants, candidate: Candidate, draws: int) -> DrawnError:
    """Return what becomes of a controller on drawn plants."""
    controller = candidate.controller
    if isinstance(controller.law, PythonLaw):
        return DrawnError(0)
    loops = DrawnLoops(controller, result.scenario, plants, ())
    if loops.operations * draws > _MOST:
        return DrawnError(0)
    names, judged = usual_names(loops, candidate.scores)
    found = replace(loops, names=names).draw(np.arange(draws + 1))
    yardstick = yardstick_of(loops, judged, found)
    bad = np.zeros(draws + 1, bool)
    for what in _UNSTABLE:
        if not found.happened[what][0]:
            bad |= found.happened[what]
    feasible = ~found.happened[Happening.INFEASIBLE][1:]
    errors = mean_error(found, yardstick)[1:][feasible] if yardstick else np.zeros(0)
    return DrawnError(
        draws=int(feasible.sum()),
        worst=float(errors.max(initial=-np.inf)) if len(errors) else np.nan,
        unsettled=int(bad[1:].sum()),
    )
