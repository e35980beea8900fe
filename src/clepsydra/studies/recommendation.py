"""What a study recommends: the best controller, and the simplest that is good enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.controllers.complexity import Complexity
from clepsydra.studies.result import ACCEPTED, Candidate, Standing


@dataclass(frozen=True)
class Recommendation:
    """Two answers of a study; one where the best is the simplest too.

    Parameters
    ----------
    simplest : Candidate
        The best of the simplest `Complexity` that is good enough.
    best : Candidate
        The first of the ranking.
    """

    simplest: Candidate
    best: Candidate

    @property
    def saved(self) -> float:
        """The share of the mean error of the simplest that the best saves [1]."""
        return 1.0 - self.best.mean_error / self.simplest.mean_error


def recommend(ranking: Sequence[Candidate], accept: float = ACCEPTED) -> Recommendation | None:
    """Return what to use; None where nothing applies, or all is unsafe or leaves a band.

    Only what stands as well as the best (robust and quiet, say) is good enough beside it. A
    plant of one loop gets the best PI or PID that stands so, however much better another is.

    Parameters
    ----------
    ranking : sequence of Candidate
        Best first.
    accept : float
        The largest relative error that is good enough.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> found = cl.study(plant, [cl.design.simc(plant), cl.design.feedback_linearisation(plant)])
    >>> found.best.controller.name, recommend(found.ranking).simplest.controller.name
    ('Feedback linearisation', 'Feedback linearisation')
    >>> recommend(found.ranking, accept=6.0).simplest.controller.name
    'PI, SIMC'
    """
    if not ranking or ranking[0].standing >= Standing.OUTSIDE:
        return None
    best = ranking[0]
    loops = _loops(ranking)
    if loops is not None:
        return Recommendation(loops, best)
    good = [
        each
        for each in ranking
        if each is best
        or (each.standing is best.standing and each.mean_error <= accept * best.mean_error)
    ]
    return Recommendation(min(good, key=lambda each: (each.controller.complexity, each.rank)), best)


def _loops(ranking: Sequence[Candidate]) -> Candidate | None:
    """Return the best PI or PID of a plant of one loop that stands as well as the best."""
    if len(ranking[0].run.process.controlled) > 1:
        return None
    for each in ranking:
        controller = each.controller
        plain = controller.complexity is Complexity.LOOPS and controller.setpoints
        if plain and each.standing is ranking[0].standing:
            return each
    return None
