"""How sure a controller is on plants that are not quite the one on paper, in a screen."""

from __future__ import annotations

import math
from collections.abc import Iterator

from clepsydra.base.section import Line, Mark, Section, Table
from clepsydra.base.words import listed
from clepsydra.report.quantities import number_text
from clepsydra.report.score_tables import score_text
from clepsydra.scores.score import SCORES
from clepsydra.scores.score_key import score_key
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.robustness.quantiles import Quantile
from clepsydra.studies.robustness.robustness import Robustness

#: A cause is named from this share of the scatter on, and so many at most.
_NAMED, _CAUSES = 0.05, 4
#: What is told of all scores, and of the first ones alone.
_SHORT = ("iae", "overshoot", "total_variation")
_ENDS = (0.5, 0.95)


def robustness_answer(found: Robustness, *, every: bool = False) -> Section:
    """Return how sure a controller is, or every score, cause and reason as well.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.robustness(cl.design.simc(plant), plant, draws=200, sensitivity=False)
    >>> robustness_answer(found).title
    'PI, SIMC on three-tanks, 200 plants'
    """
    loops = found.loops
    title = f"{loops.controller.title} on {loops.plants.point.process.name}, {found.draws:,} plants"
    parts: list[Line | Table] = [Line(_first(found), Mark.ANSWER)]
    parts += [Line(words, mark) for words, mark in _happened(found, every=every)]
    if found.sensitivity is not None:
        parts.append(Line(_causes(found), Mark.POINT))
    if found.simulated:
        parts += [Line(""), _scores(found, every=every)]
    return Section(title, tuple(parts))


def _first(found: Robustness) -> str:
    """Say how much worse it gets than on paper."""
    if not found.simulated:
        reasons = listed([f"{words} in {n:,}" for words, n in found.tally.reasons.items()])
        return f"No plant has an admissible steady state: {reasons}."
    if ERROR not in found.tally.scores:
        return "Nothing that ranks controllers is left of an error on the plant itself."
    quantile, worst = found.quantile(ERROR), found.worst()
    bounds = _bounds(quantile)
    return (
        f"On 95 % of the plants the error is at most {_times(quantile.value)} what it is on paper"
        f"{bounds}; on the worst of them, draw {worst.draw}, it is {_times(worst.value)}."
    )


def _bounds(quantile: Quantile) -> str:
    if quantile.low is None or quantile.high is None:
        return ""
    low, high = (number_text(each) for each in (quantile.low, quantile.high))
    return f" ({low} to {high})"


def _times(value: float) -> str:
    return f"{number_text(value)} times" if math.isfinite(value) else "without bound"


def _happened(found: Robustness, *, every: bool) -> Iterator[tuple[str, Mark]]:
    """Yield what happened on some plants, and what on none."""
    if not found.simulated:
        return
    never = []
    for what in Happening:
        share = found.tally.share(what)
        if share.count:
            first = found.tally.first[what]
            yield f"{str(what).capitalize()}: {share}, first in draw {first}.", Mark.WATCH
        else:
            never.append(str(what))
    if every or not found.tally.happened[Happening.INFEASIBLE]:
        for words, count in found.tally.reasons.items():
            yield f"{words}: {count:,} of {found.draws:,} draws.", Mark.POINT
    if never:
        yield f"On none of the plants: {listed(never)}.", Mark.POINT


def _causes(found: Robustness) -> str:
    """Say which parameters the scatter of the error comes from."""
    sensitivity = found.sensitivity
    assert sensitivity is not None
    if not sensitivity.known or not sensitivity.varies:
        return f"Which parameter matters: {sensitivity}."
    ordered = sorted(sensitivity.total.items(), key=lambda item: -item[1].value)
    named = [f"{name} {index}" for name, index in ordered if index.value >= _NAMED][:_CAUSES]
    return f"The scatter of the error comes from {listed(named)}."


def _scores(found: Robustness, *, every: bool) -> Table:
    process, duration = found.loops.plants.point.process, found.loops.scenario.duration
    rows = []
    for name in found.tally.scores:
        if name == ERROR:
            continue
        score, signal = score_key(name)
        if not every and score not in _SHORT:
            continue
        worst = found.worst(name)
        values = [found.nominal[name], *(found.quantile(name, c).value for c in _ENDS), worst.value]
        texts = [score_text(process, signal, value, SCORES[score], duration) for value in values]
        unit = next((unit for _, unit in texts if unit), "")
        numbers = [number for number, _ in texts]
        rows.append((f"{SCORES[score].title} of {signal}", *numbers, unit, str(worst.draw)))
    head = ("score", "on paper", "median", "95 %", "worst", "unit", "draw")
    return Table("Scores over the plants", head, tuple(rows))
