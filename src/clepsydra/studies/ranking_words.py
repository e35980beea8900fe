"""Why a controller stands where it stands, in words."""

from __future__ import annotations

import math

from clepsydra.scores.score import in_sentence
from clepsydra.studies.result import Candidate, Standing
from clepsydra.studies.warnings.harm import harms

#: Controllers whose mean differs by less are as good as each other, and their wear decides.
TIE = 1.02

#: A total variation below this share of an input's range counts as this much: the input is idle,
#: and a multiple of next to nothing says nothing.
IDLE = 0.1

#: From here on a multiple says more than a percentage.
_MANY = 3.0

#: Harms to the plant that a reason names.
_NAMED_HARMS = 2

#: How a standing is said of a controller.
STANDINGS = {
    Standing.ROBUST: "robust and quiet",
    Standing.NERVOUS: "robust",
    Standing.STABLE: "stable",
}


def reason(
    candidate: Candidate, better: Candidate | None, worse: Candidate | None, *, tied: bool
) -> str:
    """Return how far it can be trusted, its deciding numbers, and what puts it where it is.

    Parameters
    ----------
    candidate : Candidate
    better : Candidate or None
        The one before it; None for the first.
    worse : Candidate or None
        The one after the first, which is compared with it; else not looked at.
    tied : bool
        Whether the wear decides between it and the one it is compared with.

    Examples
    --------
    `clepsydra.studies.ranking.rank` gives each candidate its reason:

    >>> first = Candidate(None, None, {}, 1.5, Standing.ROBUST, 1.0, 1, "", (), {"error": 1.0})
    >>> reason(first, None, None, tied=False)
    'Robust (max|S| 1.50). Error 1.00 times the best; the least total variation.'
    """
    words = [f"{_standing(candidate)}.", _numbers(candidate)]
    if better is not None:
        words.append(_behind(candidate, better, tied))
    elif worse is not None:
        words.append(_ahead(candidate, worse, tied))
    return " ".join(words)


def _standing(candidate: Candidate) -> str:
    peak, peaks = candidate.maximum_sensitivity, _peaks(candidate)
    if math.isnan(peak) and candidate.standing is Standing.ROBUST:
        return "Safe; it switches at levels, and has no margins"
    if candidate.standing is Standing.ROBUST:
        return f"Robust ({peaks})"
    if candidate.standing is Standing.NERVOUS:
        return f"Robust ({peaks}), but noise moves its outputs too much"
    if candidate.standing is Standing.STABLE:
        return f"Stable with thin margins ({peaks})"
    harm = [each.brief for each in harms(candidate.run)]
    more = [f"{len(harm) - _NAMED_HARMS} more"] if len(harm) > _NAMED_HARMS else []
    unsafe = [*harm[:_NAMED_HARMS], *more] or ["unstable by its linear model"]
    return "Unsafe: " + "; ".join(unsafe)


def _peaks(candidate: Candidate) -> str:
    words, inner = f"max|S| {candidate.maximum_sensitivity:.2f}", _inner_peak(candidate)
    return f"{words}, {inner[1]:.2f} in the inner loop of {inner[0]}" if inner else words


def peak_sentence(candidate: Candidate) -> str:
    """Return max|S| of a controller and of its inner loops, "max|S| is 1.50; "; else nothing.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> peak_sentence(SimpleNamespace(maximum_sensitivity=1.5, response=None))
    'max|S| is 1.50; '
    """
    if math.isnan(candidate.maximum_sensitivity):
        return ""
    return f"{_peaks(candidate).replace('max|S|', 'max|S| is', 1)}; "


def _inner_peak(candidate: Candidate) -> tuple[str, float] | None:
    return candidate.response.inner_peak if candidate.response else None


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
    return f"{words[0].upper()}{words[1:]}; {_wear(candidate.wear)}."


def _wear(multiple: float) -> str:
    if abs(multiple - 1.0) < 0.005:
        return "the least total variation"
    return f"{multiple:.2f} times the least total variation"


def _behind(candidate: Candidate, better: Candidate, tied: bool) -> str:
    name = better.controller.title
    if candidate.standing is not better.standing:
        return f"Behind {name}, which is {STANDINGS[better.standing]}."
    if tied:
        if _as_calm(candidate, better):
            return f"Level with {name}, in errors and in moves."
        return f"Level with {name} to within 2 %, but {_moves(candidate.wear, better.wear)}."
    return f"Behind {name}: {_larger(candidate, better, 'its')}."


def _ahead(candidate: Candidate, worse: Candidate, tied: bool) -> str:
    name = worse.controller.title
    if candidate.standing is not worse.standing:
        return f"Ahead of {name}, which is not {STANDINGS[candidate.standing]}."
    if tied:
        if _as_calm(worse, candidate):
            return f"Level with {name}, in errors and in moves."
        return f"Level with {name} to within 2 %, which {_moves(worse.wear, candidate.wear)}."
    return f"Ahead of {name}, {_larger(worse, candidate, 'whose')}."


def _larger(worse: Candidate, better: Candidate, whose: str) -> str:
    """Return by how much, and in what most of all, one candidate is worse than another."""
    most = max(
        worse.criteria,
        key=lambda title: _difference(worse.criteria[title], better.criteria[title]),
    )
    words = in_sentence(most)
    if not math.isfinite(worse.mean_error):
        return f"{whose} {words} has no end"
    ratio = worse.mean_error / better.mean_error
    more = (
        f"{percent(100 * (ratio - 1))} larger" if ratio < _MANY else f"{ratio:.3g} times as large"
    )
    if len(worse.criteria) == 1:
        return f"{whose} {words} is {more}"
    return (
        f"{whose} mean is {more}, most of all by the {words} "
        f"({worse.criteria[most]:.2f} against {better.criteria[most]:.2f})"
    )


def _difference(worse: float, better: float) -> float:
    return worse - better if math.isfinite(better) else 0.0


def _as_calm(worse: Candidate, better: Candidate) -> bool:
    return worse.wear <= 1.005 * better.wear


def _moves(more: float, less: float) -> str:
    if less > 0.0 and math.isfinite(more):
        return f"moves its inputs {more / less:.2f} times as much"
    return "moves its inputs more"


def with_article(words: str) -> str:
    """Return words with "a" or "an" before them.

    Examples
    --------
    >>> with_article("setpoint error"), with_article("IAE of level"), with_article("overshoot")
    ('a setpoint error', 'an IAE of level', 'an overshoot')
    """
    return f"{'an' if words[:1].lower() in 'aeiou' else 'a'} {words}"


def percent(number: float) -> str:
    """Return a percentage in words that do not say 0 where it is not.

    Examples
    --------
    >>> percent(24.6), percent(0.24)
    ('25 %', '0.2 %')
    """
    return f"{number:.0f} %" if number >= 10.0 else f"{number:.1f} %"
