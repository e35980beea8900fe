"""The first screen of a study: what to use, its settings, how good, how sure, what to watch."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clepsydra.base.section import Line, Section, Table
from clepsydra.base.words import time_text
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.process.process import Process
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.performance import figures_of, performance_words
from clepsydra.report.quantities import number_text, time_cell
from clepsydra.report.scheme_tables import added_table, settings_table
from clepsydra.report.score_tables import standing_word
from clepsydra.report.study_answer import better_words, watch_lines
from clepsydra.studies.ranking import QUIET
from clepsydra.studies.recommendation import Recommendation
from clepsydra.studies.result import Candidate, Standing, StudyResult

#: Loops whose settings stand on the first screen; those of more are with the controller.
_LOOPS = 8
#: So many loops stand side by side, a setting a row.
_SIDE_BY_SIDE = 2
#: A larger gain margin is told as this.
_MANY = 100.0


@dataclass(frozen=True)
class RankingColumn:
    """A column of the ranking on a page: its title, and each controller's text and number.

    Parameters
    ----------
    title : str
    cells : tuple of (str, float)
        The number sorts, and is infinite for none.
    """

    title: str
    cells: tuple[tuple[str, float], ...]


def headline(result: StudyResult, advice: Recommendation | None) -> str:
    """Return what to use and what it does in one sentence, or why nothing is recommended.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.recommendation import recommend
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> headline(result, recommend(result.ranking))[:39]
    'Use PI, SIMC: it settles in 5.10 min, d'
    """
    if advice is None:
        return result.verdict
    words = performance_words(result.process, advice.simplest)
    return f"Use {advice.simplest.controller.title}" + (f": it {words}." if words else ".")


def lead(result: StudyResult, advice: Recommendation | None) -> str:
    """Return why this one, and what the best would need and gain; empty where nothing is used.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.recommendation import recommend
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> lead(result, recommend(result.ranking))
    'The best that was tried.'
    """
    if advice is None:
        return ""
    why = advice.why or f"the {result.verdict.partition(': the ')[2].rstrip('.')}"
    said = [f"{why[:1].upper()}{why[1:]}."]
    if advice.best is not advice.simplest:
        said.append(better_words(advice))
    return " ".join(said)


def counted_words(result: StudyResult) -> str:
    """Return how many controllers ran, and how many of them are within all limits.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> counted_words(cl.study(plant, [cl.design.simc(plant)]))
    '1 controller ran, 1 within all limits'
    """
    ran = len(result.ranking)
    good = sum(each.standing is Standing.ROBUST for each in result.ranking)
    refused = len(result.not_applicable)
    words = f"{ran} controller{'' if ran == 1 else 's'} ran, {good} within all limits"
    return f"{words}, {refused} not applicable" if refused else words


def cards(result: StudyResult, first: Candidate, rival: Candidate | None) -> list[Section]:
    """Return settings, how good, how sure and what to watch, a section each.

    Parameters
    ----------
    result : StudyResult
    first : Candidate
        The recommended one, or the first of the ranking.
    rival : Candidate or None
        With which it is compared.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> [section.title for section in cards(result, result.ranking[0], None)]
    ['Settings', 'How good', 'How sure']
    """
    found = [
        _settings(result, first),
        _how_good(result.process, first, rival),
        _how_sure(result.process, first),
    ]
    lines = watch_lines(result, first)
    return [*found, Section("Watch", lines)] if lines else found


def _settings(result: StudyResult, first: Candidate) -> Section:
    controller = first.controller
    period = time_text(result.scenario.sampling_period)
    table = settings_table(controller, result.process)
    if table is None:
        words = (
            f"{controller.design} It runs every {period}; its numbers stand with the controller."
        )
        return Section("Settings", (Line(words),))
    if len(table.rows) <= _SIDE_BY_SIDE:
        loops = ["", *(row[0] for row in table.rows)]
        rows = zip(table.head[1:], *(row[1:] for row in table.rows), strict=True)
        table = Table("", tuple(loops), tuple(rows))
    else:
        more = len(table.rows) - _LOOPS
        rest = [(f"{more} more", *[""] * (len(table.head) - 1))] if more > 0 else []
        table = Table("", ("", *table.head[1:]), (*table.rows[:_LOOPS], *rest))
    added = added_table(controller, result.process)
    tables = (table,) if added is None else (table, added)
    return Section("Settings", (*tables, Line(f"ISA form, every {period}.")))


def _how_good(process: Process, first: Candidate, rival: Candidate | None) -> Section:
    compared = [first, *([] if rival is None else [rival])]
    rows = []
    for figure in figures_of(process):
        cells = [figure.cell(process, each) for each in compared]
        if figure.score != "noise_movement" and set(cells) != {"–"}:
            worst = figure.worst(process, first)
            of = f" ({worst[0]})" if worst and len(process.controlled) > 1 else ""
            rows.append((f"{figure.title}{of}", *cells))
    rows.append(("relative error", *(f"{each.relative_error:.2f}" for each in compared)))
    head = ("", *(each.controller.title for each in compared))
    return Section("How good", (Table("", head, tuple(rows)),))


def _how_sure(process: Process, first: Candidate) -> Section:
    rows = [("standing", standing_word(first), "")]
    if not math.isnan(first.maximum_sensitivity):
        limit = f"limit {SENSITIVITY_LIMIT:g}"
        rows.append(("max|S|", f"{first.maximum_sensitivity:.2f}", limit))
    if first.response is not None:
        margins = margin_table(first.response).values()
        delay, gain, phase = (
            min(each[what] for each in margins)
            for what in ("delay margin [s]", "gain margin", "phase margin [deg]")
        )
        rows.append(("extra delay bearable", time_cell(delay), ""))
        times = f"{number_text(gain, 2)} times" if gain < _MANY else f"over {_MANY:g} times"
        rows.append(("gain may rise", times, ""))
        if math.isfinite(phase):
            rows.append(("phase margin", f"{phase:.0f}°", ""))
    noise = next(each for each in figures_of(process) if each.score == "noise_movement")
    rows.append(("noise on outputs", noise.cell(process, first), f"limit {100.0 * QUIET:.0f} %"))
    return Section("How sure", (Table("", ("", "", ""), tuple(rows)),))


def ranking_columns(result: StudyResult) -> list[RankingColumn]:
    """Return the ranking's columns behind the controllers' names: physical numbers lead.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> [column.title for column in ranking_columns(result)][:3]
    ['settles', 'deviates', 'noise']
    """
    process, ranking = result.process, result.ranking
    columns = []
    for figure in figures_of(process):
        cells = []
        for each in ranking:
            worst = figure.worst(process, each)
            cells.append((figure.cell(process, each), math.inf if worst is None else worst[1]))
        columns.append(RankingColumn(figure.title, tuple(cells)))
    criteria = ranking[0].criteria if ranking and len(ranking[0].criteria) > 1 else ()
    for title, values in (
        *((f"{name}, × best", [each.criteria[name] for each in ranking]) for name in criteria),
        ("relative error", [each.relative_error for each in ranking]),
        ("total variation, × least", [each.wear for each in ranking]),
        ("max|S|", [each.maximum_sensitivity for each in ranking]),
    ):
        cells = [(number_text(value), math.inf if math.isnan(value) else value) for value in values]
        columns.append(RankingColumn(title, tuple(cells)))
    return [column for column in columns if {text for text, _ in column.cells} - {"–"}]
