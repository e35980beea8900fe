"""The answer of a study in a screen: what to use, how good it is, what to watch."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.words import listed
from clepsydra.report.facts import told_table
from clepsydra.report.pid_tables import settings_table
from clepsydra.report.scheme_tables import added_table
from clepsydra.report.score_tables import (
    figures_of,
    performance_words,
    ranking_note,
    reasons,
    standing_word,
)
from clepsydra.scores.score import in_sentence
from clepsydra.studies.ranking_words import TIE, trust_sentence
from clepsydra.studies.recommendation import Recommendation, first_clause, recommend, watched
from clepsydra.studies.result import Candidate, StudyResult

#: Of the answer: rows of the ranking, of settings, and warnings.
RANKED, _SETTINGS, _WATCHED = 5, 3, 2
_EMPTY = Line("")


def study_answer(
    result: StudyResult, *, every: bool = False, why: bool = False, refused: bool = False
) -> Section:
    """Return what an engineer asks first, in about 25 lines of 80 columns, and more on request.

    Parameters
    ----------
    every : bool
        Whether the whole ranking is shown.
    why : bool
        Whether the reasons, all warnings and the rule of the ranking follow.
    refused : bool
        Whether what does not apply follows, with why.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> study_answer(result).parts[0].text[:32]
    'Use PI, AMIGO on Three coupled t'
    """
    advice = recommend(result.ranking, result.accept)
    parts: list[Line | Table | Section] = [Line(result.verdict, Mark.ANSWER)]
    if advice is not None:
        parts += advised(result, advice)
    if result.ranking:
        parts += [_EMPTY, ranking_glance(result.ranking if every else _first(result, advice))]
    rest = _rest(result, every, why, refused)
    parts += [Line(rest)] if rest else []
    if why:
        parts += _reasons(result)
    if refused or not result.ranking:
        parts += [_EMPTY, *_refused(result)]
    if advice is not None:
        parts += [_EMPTY, *_commands(result, advice)]
    elif result.ranking:
        parts += [_EMPTY, Line("Next: open the report, and change the process or its sampling.")]
    return Section("", tuple(parts))


def ranking_glance(shown: Sequence[Candidate]) -> Table:
    """Return candidates of a ranking in physical numbers, then beside the first of it."""
    process = shown[0].run.process
    figures = figures_of(process)
    standings = [standing_word(each) for each in shown]
    several = len(set(standings)) > 1
    head = ("", "controller", "slowed", "standing", *(each.title for each in figures))
    rows = [
        (
            str(each.rank),
            each.controller.name,
            _slowed(each),
            standing if several else "",
            *(figure.cell(process, each) for figure in figures),
            f"{each.relative_error:.2f}",
            "–" if math.isnan(each.maximum_sensitivity) else f"{each.maximum_sensitivity:.2f}",
        )
        for each, standing in zip(shown, standings, strict=True)
    ]
    return told_table((*head, "relative error", "max|S|"), rows, names=2, kept=3)


def advised(result: StudyResult, advice: Recommendation) -> list[Line | Table | Section]:
    """Return how good the recommended controller is, its settings, and what to watch."""
    process, simplest, best = result.process, advice.simplest, advice.best
    parts: list[Line | Table | Section] = []
    words = performance_words(process, simplest)
    said = [f"It {words}."] if words else []
    parts.append(Line(" ".join([*said, trust_sentence(simplest)])))
    settings = [found(simplest.controller, process) for found in (settings_table, added_table)]
    tables = [_shortened(table) for table in settings if table is not None]
    parts += [_EMPTY, *tables] if tables else []
    parts += watch_lines(result, simplest)
    if best is not simplest:
        parts.append(Line(better_words(advice)))
    return parts


def better_words(advice: Recommendation) -> str:
    """Return what the best controller gains and needs beside the simplest."""
    controller = advice.best.controller
    if advice.saved < TIE - 1.0:
        return f"{controller.name}, first of the ranking, is no better by more than 2 %."
    if not controller.setpoints:
        needs = "; it switches at levels, and holds no setpoint"
    elif controller.further_measurements:
        needs = f"; it also measures {listed(controller.further_measurements)}"
    elif controller.complexity is not advice.simplest.controller.complexity:
        needs = f"; it needs {controller.complexity.words}"
    else:
        said = watched(advice.best)
        needs = re.sub("^; It", "; it", f"; {said[0].rstrip('.')}") if said else ""
    saved = f"has {100.0 * advice.saved:.0f} % less error"
    return f"The best, {controller.title}, {saved}{needs}."


def watch_lines(result: StudyResult, candidate: Candidate) -> tuple[Line, ...]:
    """Return the first of what to watch with a controller and its run, and how much more."""
    said = [*watched(candidate)]
    for caveat in candidate.caveats:
        if caveat.seen:
            shared = [any(c.about == caveat.about for c in each.caveats) for each in result.ranking]
            where = "In every run" if all(shared) and len(shared) > 1 else "In this run"
            said.append(f"{where}: {in_sentence(first_clause(caveat.words))}")
    more = len(said) - _WATCHED
    rest = (f"{more} more to watch: --why.",) if more > 0 else ()
    return marked(Mark.WATCH, (*said[:_WATCHED], *rest))


def _first(result: StudyResult, advice: Recommendation | None) -> Sequence[Candidate]:
    """Return the first of the ranking, with the recommended one in the last row if it is later."""
    shown = result.ranking[:RANKED]
    if advice is None or advice.simplest in shown:
        return shown
    return (*shown[:-1], advice.simplest)


def _slowed(candidate: Candidate) -> str:
    factor = candidate.controller.slowed
    return "" if factor == 1.0 else f"{factor:.3g}×"


def _shortened(settings: Table) -> Table:
    more = len(settings.rows) - _SETTINGS
    if more <= 0:
        return settings
    rest = (f"{more} more rows: in the report", *[""] * (len(settings.head) - 1))
    return replace(settings, rows=(*settings.rows[:_SETTINGS], rest))


def _rest(result: StudyResult, every: bool, why: bool, refused: bool) -> str:
    """Return what is not shown, and the option that shows it."""
    more = len(result.ranking) - RANKED
    said = [f"{more} more: --all"] if more > 0 and not every else []
    said += ["why this order: --why"] if result.ranking and not why else []
    count = len(result.not_applicable)
    said += [f"{count} not applicable: --refused"] if count and not refused else []
    return "; ".join(said)


def _reasons(result: StudyResult) -> list[Line | Table | Section]:
    parts: list[Line | Table | Section] = [_EMPTY]
    for each, words in zip(result.ranking, reasons(result.ranking), strict=True):
        parts.append(Line(f"{each.rank}  {each.controller.title}: {words}"))
    for each in result.ranking:
        titled = (f"{each.controller.title}: {words}" for words in each.warnings)
        parts += marked(Mark.WATCH, titled)
    parts += marked(Mark.WATCH, result.caveats)
    return [*parts, _EMPTY, Line(ranking_note(result))]


def _refused(result: StudyResult) -> tuple[Line, ...]:
    named = (f"{name} does not apply: {reason}" for name, reason in result.not_applicable)
    return marked(Mark.REFUSED, named)


def _commands(result: StudyResult, advice: Recommendation) -> tuple[Line, ...]:
    subject = str(result.path or result.process.address)
    subject = f'"{subject}"' if " " in subject else subject
    controller = f'--controller "{advice.simplest.controller.name}"'
    return marked(
        Mark.COMMAND,
        (
            f"Next: clepsydra export {subject} {controller} --to st",
            f"      clepsydra verify {subject} {controller}",
        ),
    )
