"""How sure a controller is on plants that are not quite the one on paper, in a screen."""

from __future__ import annotations

import math
from collections.abc import Iterator

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.words import listed
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.report.quantities import number_text
from clepsydra.report.robustness_tables import (
    causes_table,
    events_table,
    score_title,
    scores_table,
    varied_table,
)
from clepsydra.studies.robustness.drawn_loops import ERROR
from clepsydra.studies.robustness.drawn_scores import Happening
from clepsydra.studies.robustness.quantiles import Quantile
from clepsydra.studies.robustness.robustness import Robustness

#: A cause is named from this share of the scatter on, and so many at most.
_NAMED, _CAUSES = 0.05, 4
#: Of the answer: scores, and what happens, the worst first.
_SCORES, _HAPPENED = 6, 3
_ORDER = (
    Happening.INFEASIBLE, Happening.UNSTABLE, Happening.HARM, Happening.OVERFLOW, Happening.DRY,
    Happening.STEADY, Happening.UNSOLVED,
)  # fmt: skip
#: An error that scatters less than this between 5 and 95 % of the plants is the same on all.
_ALIKE = 0.002
_STILL = "Nothing varies but the noise: [uncertainty] holds every parameter at its value."
#: What says nothing of a plant, and stands with the rest.
_TECHNICAL = (Happening.UNSOLVED,)


def robustness_answer(found: Robustness, *, every: bool = False) -> Section:
    """Return how sure a controller is in 24 lines of 80 columns, or all that is known.

    Parameters
    ----------
    every : bool
        Whether with every score, event, cause and reason, and with what varies.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.robustness(cl.design.simc(plant), plant, draws=200, sensitivity=False)
    >>> robustness_answer(found).title
    'PI, SIMC on three-tanks: 200 plants, 9 parameters within 10 %'
    """
    parts: list[Line | Table] = [*answer_lines(found, every=every)]
    parts += marked(Mark.WATCH, found.notes)
    if every:
        parts += every_table(found)
    elif found.simulated:
        parts += [Line(""), scores_table(found, _SCORES)]
        parts.append(Line("Every score, event, cause and parameter: --all"))
    parts += [Line(""), Line(_next(found), Mark.NEXT)]
    return Section(robustness_title(found), tuple(parts))


def robustness_title(found: Robustness) -> str:
    """Return which controller was put on how many plants of what."""
    controller, count = found.loops.controller, len(found.spread.signals)
    plants = f"{found.draws:,} plant{'s' if found.draws > 1 else ''}"
    title = f"{controller.title} on {found.plants.point.process.name}: {plants}"
    if not count:
        return title
    parameters = f"{count} parameter{'s' if count > 1 else ''}"
    plain = found.plants.uncertainty == Uncertainty()
    return f"{title}, {parameters} {'within 10 %' if plain else 'as [uncertainty] says'}"


def every_table(found: Robustness) -> list[Table]:
    """Return the tables of all that is known; those without rows are left out."""
    tables = [causes_table(found), varied_table(found)]
    if found.simulated:
        tables = [scores_table(found), events_table(found), *tables]
    return [table for table in tables if table.rows]


def answer_lines(found: Robustness, *, every: bool = False) -> list[Line]:
    """Return how much worse it gets, what happens and what never, and what matters."""
    lines = [Line(_first(found), Mark.ANSWER)]
    lines += [Line(words, mark) for words, mark in _happened(found, every=every)]
    if not found.spread.signals:
        lines.append(Line(_STILL, Mark.WATCH))
    if every and found.simulated and found.loops.yardstick:
        lines.append(Line(_meant(found), Mark.POINT))
    if found.sensitivity is not None:
        lines.append(Line(_causes(found), Mark.POINT))
    return lines


def _first(found: Robustness) -> str:
    """Say how much worse it gets than on paper, and whether the loop settles."""
    if not found.simulated:
        return f"No plant has an admissible steady state, {_reasons(found, every=True)}."
    settles = _settles(found)
    if ERROR not in found.tally.scores:
        return f"On paper no error is left that others could be compared with; {settles}."
    quantile, worst = found.quantile(ERROR), found.worst()
    plants = "of the plants"
    if found.simulated < found.draws:
        plants = f"of the {found.simulated:,} plants that have a steady state"
    if math.isinf(quantile.value):
        half = found.quantile(ERROR, 0.5).value
        if math.isinf(half):
            return f"On more than half {plants} the loop breaks."
        return (
            f"On more than 5 % {plants} the loop breaks, while on half of them the error is at "
            f"most {number_text(half)} times what it is on paper."
        )
    most = number_text(quantile.value)
    said = f"On 95 % {plants} the error is at most {most} times what it is on paper"
    said += _bounds(quantile)
    if {number_text(each or 0.0) for each in (quantile.low, quantile.high)} == {"1.00"}:
        said = f"On 95 % {plants} the error is what it is on paper, to a percent"
    breaks = f"on the worst, draw {worst.draw}, the loop breaks"
    if math.isfinite(worst.value):
        breaks = f"on the worst, draw {worst.draw}, it is {number_text(worst.value)} times"
    return f"{said}; {breaks}, and {settles}."


def _settles(found: Robustness) -> str:
    share = found.tally.share(Happening.UNSTABLE)
    if Happening.UNSTABLE in found.on_paper:
        return "the loop does not settle on paper either"
    if share.count:
        return f"the loop does not settle on {share.count:,} of them"
    return "the loop settles on all"


def _bounds(quantile: Quantile) -> str:
    """Return the interval of a quantile in brackets, or how many draws one takes."""
    return f" ({quantile.words(number_text).partition(' (')[2]}"


def _happened(found: Robustness, *, every: bool) -> Iterator[tuple[str, Mark]]:
    """Yield what happens on some plants, what on paper as well, and what on none."""
    if not found.simulated:
        return
    shares = {what: found.tally.share(what) for what in _ORDER}
    seen = [what for what in _ORDER if shares[what].count and what not in found.on_paper]
    shown = seen if every else seen[:_HAPPENED]
    for what in shown:
        first = f"as in draw {found.tally.first[what]}"
        if what is Happening.INFEASIBLE:
            first = _reasons(found, every=every)
        yield f"{str(what).capitalize()}: {shares[what]}, {first}.", Mark.WATCH
    if len(shown) < len(seen):
        more = listed([f"{what} ({shares[what].count:,})" for what in seen[len(shown) :]])
        yield f"And {more}.", Mark.WATCH
    for what in _ORDER:
        if what in found.on_paper:
            yield f"{str(what).capitalize()} on paper too, and in {shares[what]}.", Mark.POINT
    untold = () if every else _TECHNICAL
    never = [w for w in _ORDER if not shares[w].count and w not in {*untold, *found.on_paper}]
    if never:
        # What holds for the fewest of them holds for each.
        most = str(max((shares[what] for what in never), key=lambda share: share.high))
        bound = most.rpartition(", ")[2]
        names = ", ".join(map(str, never))
        yield f"Never seen, so each on {bound} of plants: {names}.", Mark.POINT


def _reasons(found: Robustness, *, every: bool) -> str:
    """Say why plants have no steady state: the first reason, or each with its draws."""
    ordered = sorted(found.tally.reasons.items(), key=lambda item: -item[1])
    if every:
        return f"as {listed([f'{words} ({count:,})' for words, count in ordered])}"
    return f"{'mostly ' if len(ordered) > 1 else ''}as {ordered[0][0]}"


def _meant(found: Robustness) -> str:
    """Say what the error is."""
    names = "; ".join(score_title(name) for name in found.loops.yardstick)
    return f"The error is the mean of these, each as a multiple of what it is on paper: {names}."


def _causes(found: Robustness) -> str:
    """Say from which parameters the scatter of the error comes."""
    sensitivity = found.sensitivity
    assert sensitivity is not None
    if not sensitivity.known:
        rows = sensitivity.rows + sensitivity.left_out
        return (
            f"Which parameters matter is unknown: {sensitivity.left_out:,} of {rows:,} comparisons "
            "have a plant without a steady state, or a loop that breaks. Narrow [uncertainty]."
        )
    if not scatters(found):
        return "No parameter matters: the error is as good as the same on all plants."
    ordered = sorted(sensitivity.total.items(), key=lambda item: -item[1].value)
    named = [f"{name} {index}" for name, index in ordered if index.value >= _NAMED][:_CAUSES]
    rest = len(ordered) - len(named)
    more = f"; {rest} others matter less" if rest else ""
    return f"The scatter of the error comes from {listed(named)}{more}."


def scatters(found: Robustness) -> bool:
    """Tell whether it is known from which parameters the error scatters, beyond rounding."""
    sensitivity = found.sensitivity
    if sensitivity is None or not (sensitivity.known and sensitivity.varies and found.simulated):
        return False
    low, high = (found.quantile(ERROR, chance).value for chance in (0.05, 0.95))
    return high - low > _ALIKE


def _next(found: Robustness) -> str:
    if not found.simulated:
        return "Next: narrow [uncertainty] of the process file, or choose another operating point."
    worst = "Next: see the worst plant on the page"
    if found.tally.happened[Happening.UNSTABLE]:
        return f"{worst}; try a calmer controller: --controller"
    if found.sensitivity is None or not scatters(found):
        return f"{worst}."
    total = found.sensitivity.total
    first = max(total, key=lambda name: total[name].value)
    if found.plants.uncertainty == Uncertainty():
        return f"{worst}; write how well {first} is known into [uncertainty]."
    return f"{worst}; measure {first} better: it matters most."
