"""What a controller does in the other cases of its study, in a sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence

from clepsydra.base.words import listed
from clepsydra.scores.score import in_sentence
from clepsydra.scores.score_key import score_key
from clepsydra.studies.judge import Judge
from clepsydra.studies.result import BASE_CASE, Candidate, Standing, StudyResult
from clepsydra.studies.warnings.harm import harms

#: From here on a multiple is told in whole numbers.
_MANY = 10.0


def error_beside_base(candidate: Candidate, case: str, scores: Sequence[str]) -> float | None:
    """Return the error in a case as a multiple of that in the base case; None for none.

    Parameters
    ----------
    scores : sequence of str
        What the study judges by; empty for the usual.
    """
    base, there = candidate.cases[BASE_CASE], candidate.cases[case]
    if base is None or there is None:
        return None
    found = Judge(base, [base], base.standing, scores).criteria(there)
    return sum(found.values()) / len(found)


def cases_sentence(result: StudyResult, candidate: Candidate) -> str:
    """Return in which cases a controller can be used, and why not in the others.

    Empty where the study has no cases.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> lower = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    >>> found = cl.study(plant, [cl.design.simc(plant)], cases={"low": lower})
    >>> cases_sentence(found, found.best)
    'Also low (0.99 times the error of the base case).'
    """
    scores = result.judged_by
    error = in_sentence(score_key(scores[0]).title) if len(scores) == 1 else "error"
    used: list[str] = []
    thin: list[str] = []
    refused: list[str] = []
    for name in result.cases:
        there = candidate.cases[name]
        if there is None or there.standing >= Standing.OUTSIDE:
            refused.append(f"{name}: {_why_not(there)}")
            continue
        times = f"{times_text(error_beside_base(candidate, name, scores))} times"
        times += "" if used or thin else f" the {error} of the {BASE_CASE}"
        (used if there.standing < Standing.STABLE else thin).append(f"{name} ({times})")
    parts = [f"also {listed(used)}"] if used else []
    parts += [f"with thin margins {listed(thin)}"] if thin else []
    parts += [f"not {each}" for each in refused]
    words = "; ".join(parts)
    return f"{words[:1].upper()}{words[1:]}." if words else ""


def times_text(multiple: float | None) -> str:
    """Return a multiple of an error in two digits or more; a dash for none.

    Examples
    --------
    >>> times_text(1.304), times_text(23.6), times_text(None)
    ('1.30', '24', '–')
    """
    if multiple is None or math.isnan(multiple):
        return "–"
    if math.isinf(multiple):
        return "endless"
    return f"{multiple:.2f}" if multiple < _MANY else f"{multiple:.0f}"


def _why_not(candidate: Candidate | None) -> str:
    if candidate is None:
        return "does not apply"
    if candidate.standing is Standing.OUTSIDE:
        return "leaves its band"
    harm = [each.brief.rstrip(".") for each in harms(candidate.run)]
    return harm[0] if harm else "unstable"
