"""Why a controller stands where it stands, in words."""

from __future__ import annotations

import math

from clepsydra.base.words import listed
from clepsydra.scores.score import in_sentence
from clepsydra.studies.departure import departures
from clepsydra.studies.result import Candidate, Standing
from clepsydra.studies.warnings.harm import harms
from clepsydra.studies.warnings.strokes import driven_to_and_fro
from clepsydra.studies.worst_case import least_trusted_case, worst_case

#: Controllers whose mean differs by less are as good as each other, and their wear decides.
TIE = 1.02

#: From here on a multiple says more than a percentage.
_MANY = 3.0

#: Who moves the inputs by less more than another than this is as calm.
_AS_CALM = 1.005
#: Harms to the plant that a reason names.
_NAMED_HARMS = 2

#: How a standing is said of a controller.
STANDINGS = {
    Standing.ROBUST: "robust and quiet",
    Standing.NERVOUS: "robust",
    Standing.STABLE: "stable",
    Standing.OUTSIDE: "not unsafe",
}


def reason(candidate: Candidate, rival: Candidate | None, *, ahead: bool, tied: bool) -> str:
    """Return how far it can be trusted, its deciding numbers, and what puts it where it is.

    Parameters
    ----------
    rival : Candidate or None
        The one before it; of the first the one after it.
    ahead : bool
        Whether it is the first.
    tied : bool
        Whether the wear decides between it and the one it is compared with.
    """
    words = [trust_sentence(candidate), _numbers(candidate)]
    if rival is not None:
        words.append(_beside(candidate, rival, ahead, tied))
    return " ".join(words)


def _standing(candidate: Candidate) -> str:
    peak, peaks = candidate.maximum_sensitivity, _peaks(candidate)
    if math.isnan(peak) and candidate.standing is Standing.ROBUST:
        return "Safe; it switches at levels, and has no margins"
    if candidate.standing is Standing.ROBUST:
        return f"Robust ({peaks})"
    if candidate.standing is Standing.NERVOUS:
        driven = [each.input for each in driven_to_and_fro(candidate.run)]
        if driven:
            return f"Robust ({peaks}), but a step drives {listed(driven)} to and fro"
        return f"Robust ({peaks}), but noise moves its outputs too much"
    if candidate.standing is Standing.STABLE:
        return f"Stable with thin margins ({peaks})"
    if candidate.standing is Standing.OUTSIDE:
        words = "; ".join(departures(candidate.run.process, candidate.scores))
        return f"Leaves its band: {words} ({peaks})"
    harm = [each.brief for each in harms(candidate.run)]
    more = [f"{len(harm) - _NAMED_HARMS} more"] if len(harm) > _NAMED_HARMS else []
    unsafe = [*harm[:_NAMED_HARMS], *more] or ["unstable by its linear model"]
    return "Unsafe: " + "; ".join(unsafe)


def _peaks(candidate: Candidate) -> str:
    words, inner = f"max|S| {candidate.maximum_sensitivity:.2f}", candidate.inner_peak
    return f"{words}, {inner[1]:.2f} in the inner loop of {inner[0]}" if inner else words


def trust_sentence(candidate: Candidate) -> str:
    """Return how far a controller can be trusted, with max|S|, in a sentence.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> trust_sentence(SimpleNamespace(
    ...     standing=Standing.ROBUST, maximum_sensitivity=1.5, inner_peak=None, cases={}))
    'Robust (max|S| 1.50).'
    """
    if candidate.standing is Standing.STABLE and (unsettled := _unsettled(candidate)):
        return f"{unsettled} ({_peaks(candidate)})."
    if not candidate.cases:
        return f"{_standing(candidate)}."
    case = least_trusted_case(candidate)
    if case.candidate is None:
        return f"Does not apply in a case ({case.name})."
    if case.candidate.standing is Standing.ROBUST:
        peaks = _peaks(case.candidate)
        return f"Robust in every case, with the thinnest margin ({case.name}) at {peaks}."
    return f"In the worst case ({case.name}): {in_sentence(_standing(case.candidate))}."


def _unsettled(candidate: Candidate) -> str:
    """Return on how many drawn plants it does not settle; empty where it does on all."""
    drawn = candidate.drawn
    if drawn is None or not drawn.unsettled:
        return ""
    return f"Does not settle on {drawn.unsettled} of {drawn.draws} drawn plants"


def _numbers(candidate: Candidate) -> str:
    """Return the numbers of the ranking's table."""
    several = [
        f"{in_sentence(title)} {value:.2f}"
        if math.isfinite(value)
        else f"{in_sentence(title)} without end"
        for title, value in candidate.criteria.items()
    ]
    words = " and ".join(several) + " times the best"
    if len(several) > 1 and math.isfinite(candidate.mean_error):
        words += f", {candidate.mean_error:.2f} in the mean"
    if candidate.cases:
        words += f" in the worst case ({worst_case(candidate).name})"
    return f"{words[0].upper()}{words[1:]}; {_wear(candidate.wear)}."


def _wear(multiple: float) -> str:
    if abs(multiple - 1.0) < 0.005:
        return "the least total variation"
    return f"{multiple:.2f} times the least total variation"


def _beside(candidate: Candidate, rival: Candidate, ahead: bool, tied: bool) -> str:
    name, place = rival.controller.title, "Ahead of" if ahead else "Behind"
    worse, better = (rival, candidate) if ahead else (candidate, rival)
    if worse.standing is Standing.OUTSIDE is not better.standing:
        return f"{place} {name}, which {'leaves' if ahead else 'keeps'} the band."
    if worse.standing is not better.standing:
        return f"{place} {name}, which is {'not ' if ahead else ''}{STANDINGS[better.standing]}."
    if tied and worse.wear <= _AS_CALM * better.wear:
        return f"As good as {name}, in errors and in moves."
    if tied:
        which = "which" if ahead else "but"
        return f"As good as {name} to within 2 %, {which} {_moves(worse.wear, better.wear)}."
    return f"{place} {name}{', whose' if ahead else ': its'} {_larger(worse, better)}."


def _larger(worse: Candidate, better: Candidate) -> str:
    """Return by how much, and in what most of all, one candidate is worse than another."""
    most = max(
        worse.criteria,
        key=lambda title: _difference(worse.criteria[title], better.criteria[title]),
    )
    words = in_sentence(most)
    if not math.isfinite(worse.mean_error):
        return f"{words} has no end"
    ratio = worse.mean_error / better.mean_error
    more = (
        f"{percent(100 * (ratio - 1))} larger" if ratio < _MANY else f"{ratio:.3g} times as large"
    )
    if len(worse.criteria) == 1:
        return f"{words} is {more}"
    return (
        f"mean is {more}, most of all by the {words} "
        f"({worse.criteria[most]:.2f} against {better.criteria[most]:.2f})"
    )


def _difference(worse: float, better: float) -> float:
    return worse - better if math.isfinite(better) else 0.0


def _moves(more: float, less: float) -> str:
    if less > 0.0 and math.isfinite(more):
        return f"moves its inputs {more / less:.2f} times as much"
    return "moves its inputs more"


def percent(number: float) -> str:
    """Return a percentage in words that do not say 0 where it is not.

    Examples
    --------
    >>> percent(24.6), percent(0.24)
    ('25 %', '0.2 %')
    """
    return f"{number:.0f} %" if number >= 10.0 else f"{number:.1f} %"
