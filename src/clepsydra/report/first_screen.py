"""The first screen of a study: what to use, its settings, how good, how sure, what to watch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.section import Line, Section, Table
from clepsydra.base.words import time_text
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.process.process import Process
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.pid_tables import settings_table
from clepsydra.report.quantities import number_text, time_cell
from clepsydra.report.scheme_tables import added_table
from clepsydra.report.score_tables import figures_of, performance_words, standing_word
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
    """Return what to use and what it does in one sentence, or why nothing is recommended."""
    if advice is None:
        return result.verdict
    words = performance_words(result.process, advice.simplest)
    return f"Use {advice.simplest.controller.title}" + (f": it {words}." if words else ".")


def lead(result: StudyResult, advice: Recommendation | None) -> str:
    """Return why this one, and what the best would need and gain; empty where nothing is used."""
    if advice is None:
        return ""
    why = advice.why or f"the {result.verdict.partition(': the ')[2].rstrip('.')}"
    said = [f"{why[:1].upper()}{why[1:]}."]
    if advice.best is not advice.simplest:
        said.append(better_words(advice))
    return " ".join(said)


def counted_words(result: StudyResult) -> str:
    """Return how many controllers ran, and how many of them are within all limits."""
    ran = len(result.ranking)
    good = sum(each.standing is Standing.ROBUST for each in result.ranking)
    refused = len(result.not_applicable)
    words = f"{ran} controller{'' if ran == 1 else 's'} ran, {good} within all limits"
    return f"{words}, {refused} not applicable" if refused else words


def cards(result: StudyResult, compared: Sequence[Candidate]) -> list[Section]:
    """Return of the first candidate settings, how good, how sure and what to watch."""
    process, first = result.process, compared[0]
    found = [_settings(result, first), _how_good(process, compared), _how_sure(process, first)]
    lines = watch_lines(result, first)
    return [*found, Section("Watch", lines)] if lines else found


def _settings(result: StudyResult, first: Candidate) -> Section:
    controller = first.controller
    period = time_text(result.scenario.sampling_period)
    table = settings_table(controller, result.process)
    if table is None:
        words = f"It runs every {period}; its numbers stand with the controller."
        return Section("Settings", (Line(f"{controller.design} {words}"),))
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


def _how_good(process: Process, compared: Sequence[Candidate]) -> Section:
    rows = []
    for figure in figures_of(process):
        cells = [figure.cell(process, each) for each in compared]
        if figure.score != "noise_movement" and set(cells) != {"–"}:
            worst = figure.worst(process, compared[0])
            of = f" ({worst[0]})" if worst and len(process.controlled) > 1 else ""
            rows.append((f"{figure.title}{of}", *cells))
    rows.append(("relative error", *(f"{each.relative_error:.2f}" for each in compared)))
    head = ("", *(each.controller.title for each in compared))
    return Section("How good", (Table("", head, tuple(rows)),))


def _how_sure(process: Process, first: Candidate) -> Section:
    rows = [("standing", standing_word(first), "")]
    if not math.isnan(peak := first.maximum_sensitivity):
        rows.append(("max|S|", f"{peak:.2f}", f"limit {SENSITIVITY_LIMIT:g}"))
    if first.response is not None:
        margins = [tuple(each.values()) for each in margin_table(first.response).values()]
        gain, phase, _, delay, _ = map(min, zip(*margins, strict=True))
        rows.append(("extra delay bearable", time_cell(delay), ""))
        times = f"{number_text(gain, 2)} times" if gain < _MANY else f"over {_MANY:g} times"
        rows.append(("gain may rise", times, ""))
        if math.isfinite(phase):
            rows.append(("phase margin", f"{phase:.0f}°", ""))
    noise = next(each for each in figures_of(process) if each.score == "noise_movement")
    rows.append(("noise on outputs", noise.cell(process, first), f"limit {100.0 * QUIET:.0f} %"))
    return Section("How sure", (Table("", ("", "", ""), tuple(rows)),))


def ranking_columns(result: StudyResult) -> list[RankingColumn]:
    """Return the ranking's columns behind the controllers' names: physical numbers lead."""
    process, ranking = result.process, result.ranking
    columns = []
    for figure in figures_of(process):
        worst = [figure.worst(process, each) for each in ranking]
        numbers = [math.inf if each is None else each[1] for each in worst]
        texts = [figure.cell(process, each) for each in ranking]
        columns.append(RankingColumn(figure.title, tuple(zip(texts, numbers, strict=True))))
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
