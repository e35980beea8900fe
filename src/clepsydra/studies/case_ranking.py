"""The order of the controllers of a study of several cases: the worst case decides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from clepsydra.studies.ranking import Trial, in_order, judged, rank
from clepsydra.studies.result import BASE_CASE, Candidate, Standing
from clepsydra.studies.worst_case import worst_case

#: What the rule of a ranking says besides, where there are several cases.
CASES_RULE = (
    " Of several cases each controller's worst one counts: it stands as it does where it stands "
    "worst, and the largest of its errors decides, each a multiple of the best in that case, and "
    "between equals the largest of its moves; one that does not apply in a case comes last."
)


class CaseRankings(NamedTuple):
    """The order over all cases, and that in each of the others than the base case."""

    overall: tuple[Candidate, ...]
    by_case: Mapping[str, tuple[Candidate, ...]]


def rank_cases(
    trials: Sequence[Trial], cases: Mapping[str, Sequence[Trial]], scores: Sequence[str] = ()
) -> CaseRankings:
    """Return the candidates of the base case, best over all cases first, and those of each case.

    In each case errors are multiples of the best among the controllers that come first over all
    cases, so that one which is fast in a case and unsafe in another moves no other's place.

    Parameters
    ----------
    trials : sequence of Trial
        In the base case.
    cases : mapping
        Each other case to the trials there, of the same names.
    scores : sequence of str
        As for `clepsydra.studies.ranking.rank`.
    """
    if not cases or not trials:
        return CaseRankings(rank(trials, scores), dict.fromkeys(cases, ()))
    every = {BASE_CASE: trials, **cases}
    known = {case: {each.controller.name: each for each in tried} for case, tried in every.items()}
    standings = {
        name: max(
            found[name].standing if name in found else Standing.UNSAFE for found in known.values()
        )
        for name in known[BASE_CASE]
    }
    first = {name for name, standing in standings.items() if standing is min(standings.values())}
    found = {}
    for case, tried in every.items():
        best_of = [each for each in tried if each.controller.name in first] or tried
        found[case] = in_order(judged(tried, best_of, scores))
    by_name = {case: {each.controller.name: each for each in own} for case, own in found.items()}
    overall = [
        _over_all(trial, {case: by_name[case].get(trial.controller.name) for case in every})
        for trial in trials
    ]
    return CaseRankings(in_order(overall), {name: found[name] for name in cases})


def _over_all(trial: Trial, cases: Mapping[str, Candidate | None]) -> Candidate:
    """Return a controller as its cases have it together."""
    own = cases[BASE_CASE]
    assert own is not None, trial.controller.name
    together = replace(own, cases=cases)
    worst = worst_case(together).candidate
    applied = [each for each in cases.values() if each is not None]
    return replace(
        together,
        standing=max(each.standing for each in applied) if worst else Standing.UNSAFE,
        mean_error=worst.mean_error if worst else float("inf"),
        criteria=worst.criteria if worst else dict.fromkeys(own.criteria, float("inf")),
        wear=max(each.wear for each in applied),
    )
