"""What a study recommends, the best and the simplest that is good enough, and what to watch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.remark import Remark
from clepsydra.controllers.controller import Complexity
from clepsydra.studies.ranking_words import TIE
from clepsydra.studies.result import ACCEPTED, Candidate, Standing


@dataclass(frozen=True)
class Recommendation:
    """Two answers of a study; one where the best is the simplest too.

    Parameters
    ----------
    simplest : Candidate
        Of the simplest `Complexity` that is good enough, the one with the least to watch.
    best : Candidate
        The first of the ranking.
    why : str
        Why the simplest, in words that follow "Use ...: "; empty where it is the best.
    """

    simplest: Candidate
    best: Candidate
    why: str = ""

    @property
    def saved(self) -> float:
        """The share of the mean error of the simplest that the best saves [1]."""
        return 1.0 - self.best.mean_error / self.simplest.mean_error


def recommend(ranking: Sequence[Candidate], accept: float = ACCEPTED) -> Recommendation | None:
    """Return what to use; None where nothing applies, or all is unsafe or leaves a band.

    Only what stands as well as the best (robust and quiet, say) is good enough beside it. A
    plant of one loop gets a PI or PID that stands so, however much better another is; its error
    is compared with that of the best PI or PID. Among those of the simplest kind that are good
    enough the one with the least to watch is taken, then the first of the ranking: what is a
    little slower without an overshoot is what an engineer would leave behind.

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
    equals = [each for each in ranking if each.standing is best.standing]
    candidates = _loops(equals) or equals
    good = [
        each
        for each in candidates
        if each is candidates[0] or each.mean_error <= accept * candidates[0].mean_error
    ]
    kind = min(each.controller.complexity for each in good)
    simplest = [each for each in good if each.controller.complexity is kind]
    chosen = min(simplest, key=lambda each: (len(watched(each)), each.rank))
    if chosen is best:
        return Recommendation(chosen, best)
    if chosen is not simplest[0]:
        why = f"good enough, with fewer warnings than {simplest[0].controller.name}"
    elif chosen.mean_error <= accept * best.mean_error:
        why = "the simplest that is good enough"
    else:
        why = "the best PI or PID"
    return Recommendation(chosen, best, why)


def _loops(equals: Sequence[Candidate]) -> Sequence[Candidate]:
    """Return the PI and PID controllers of a plant of one loop; none where it has several."""
    if len(equals[0].run.process.controlled) > 1:
        return ()
    return [
        each
        for each in equals
        if each.controller.complexity is Complexity.LOOPS and each.controller.setpoints
    ]


def rival_of(ranking: Sequence[Candidate]) -> Candidate | None:
    """Return whom the first of a ranking is told beside: the next that is more than a detail off.

    One of the same `Complexity` and standing and of as good an error, as the ranking has it, is
    the same to its reader but for a lag or a filter; where there are only such, the second is
    told.
    """
    others = [each for each in ranking[1:] if not _alike(ranking[0], each)]
    return next(iter([*others, *ranking[1:]]), None)


def as_good_as_first(ranking: Sequence[Candidate]) -> list[Candidate]:
    """Return those of a ranking that are the same as the first but for a detail: see `rival_of`."""
    return [each for each in ranking[1:] if _alike(ranking[0], each)]


def _alike(first: Candidate, other: Candidate) -> bool:
    kinds = {(each.controller.complexity, each.standing) for each in (first, other)}
    return len(kinds) == 1 and other.mean_error <= TIE * first.mean_error


def watched(candidate: Candidate) -> tuple[Remark, ...]:
    """Return what to watch with a controller; its standing is told elsewhere.

    A level that averages is judged by the flow that it smooths, so its overshoot is left out. What
    simulation and scenario leave open is no property of the controller: see `Candidate.caveats`.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank-nonminimum-phase")
    >>> for each in watched(cl.study(plant, [cl.design.amigo(plant)]).best):
    ...     print(each.brief)
    Its rule was slowed 1.22 times, until it was robust.
    """
    said = [*candidate.overshoots]
    if candidate.controller.slowed > 1.0:
        factor = f"{candidate.controller.slowed:.3g}"
        said.append(Remark(f"Its rule was slowed {factor} times, until it was robust"))
    return (*said, *candidate.warnings)
