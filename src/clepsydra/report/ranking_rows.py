"""A controller in a row: of the ranking, and on its own as soon as it has been tried."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from clepsydra.base.section import Line, Table
from clepsydra.report.facts import told_table
from clepsydra.report.figures import figures_of
from clepsydra.report.quantities import number_text
from clepsydra.studies.ranking import Trial
from clepsydra.studies.result import Candidate, Standing

#: Of the ranking in an answer.
RANKED = 5
#: The head of the column that compares with the physical limit.
TIMES = "× limit"
#: The standing of a controller in a word.
STANDING_WORDS = {
    Standing.ROBUST: "robust",
    Standing.NERVOUS: "nervous",
    Standing.STABLE: "thin margins",
    Standing.OUTSIDE: "leaves its band",
    Standing.UNSAFE: "unsafe",
}


def standing_word(candidate: Candidate | Trial) -> str:
    """Return how far a controller can be trusted, in a word."""
    if candidate.standing is Standing.ROBUST and math.isnan(candidate.maximum_sensitivity):
        return "safe"
    return STANDING_WORDS[candidate.standing]


def ranking_glance(
    shown: Sequence[Candidate], times: Callable[[Candidate], float | None] = lambda _: None
) -> Table:
    """Return candidates of a ranking in physical numbers, then beside the first of it.

    Parameters
    ----------
    times : callable, optional
        Candidate to how many times the physical limit it is, where that is known.
    """
    process = shown[0].run.process
    figures = figures_of(process)
    standings = [standing_word(each) for each in shown]
    several = len(set(standings)) > 1
    head = ("", "controller", "slowed", "standing", *(each.title for each in figures))
    slowed = [each.controller.slowed for each in shown]
    rows = [
        (
            str(each.rank),
            each.controller.name,
            "" if factor == 1.0 else f"{factor:.3g}×",
            standing if several else "",
            *(figure.cell(process, each) for figure in figures),
            number_text(each.relative_error),
            worst_cell(each),
            number_text(math.nan if (limit := times(each)) is None else limit),
            number_text(each.maximum_sensitivity),
        )
        for each, standing, factor in zip(shown, standings, slowed, strict=True)
    ]
    named = (*head, "relative error", worst_head(shown), TIMES, "max|S|")
    return told_table(named, rows, names=2, kept=3)


def worst_head(shown: Sequence[Candidate]) -> str:
    """Return the head of the column of errors on drawn plants, "worst of 64"."""
    draws = max((each.drawn.draws for each in shown if each.drawn), default=0)
    return f"worst of {draws}"


def worst_cell(candidate: Candidate) -> str:
    """Return the error on the worst of the drawn plants, beside the first of the ranking."""
    drawn = candidate.drawn
    if drawn is None or not drawn.draws:
        return "–"
    if drawn.unsettled:
        return f"{drawn.unsettled} unstable"
    return number_text(candidate.relative_error * drawn.worst)


def trial_line(trial: Trial) -> Line:
    """Return a controller that has just been tried, in physical numbers and without a place."""
    process = trial.run.process
    told = [(figure.title, figure.cell(process, trial)) for figure in figures_of(process)]
    told.append(("max|S|", number_text(trial.maximum_sensitivity)))
    said = ", ".join(f"{title} {cell}" for title, cell in told if cell != "–")
    return Line(f"{trial.controller.name}: {standing_word(trial)}; {said}")


def worst_compared(candidate: Candidate) -> float:
    """Return the number by which that column is sorted."""
    drawn = candidate.drawn
    if drawn is None or not drawn.draws or math.isnan(drawn.worst):
        return math.inf
    return math.inf if drawn.unsettled else candidate.relative_error * drawn.worst
