"""The answer of a study in a screen: what to use, how good it is, what to watch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from clepsydra.base.section import Line, Mark, Section, Table, marked
from clepsydra.base.words import listed, time_text
from clepsydra.controllers.python_law import PythonLaw
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.process.process import Process
from clepsydra.report.alarm_tables import alarm_words, alarms_of_study
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.case_tables import (
    case_by_case,
    error_in_cases,
    settings_anew,
    watched_in_cases,
)
from clepsydra.report.drawn_words import drawn_words
from clepsydra.report.facts import first_rows
from clepsydra.report.figures import figures_of, performance_words
from clepsydra.report.limit_answer import limit_words
from clepsydra.report.pid_tables import settings_table
from clepsydra.report.quantities import number_text, time_cell
from clepsydra.report.ranking_rows import (
    RANKED,
    TIMES,
    ranking_glance,
    standing_word,
    worst_cell,
    worst_compared,
    worst_head,
)
from clepsydra.report.scheme_tables import added_table
from clepsydra.report.score_tables import ranking_notes, reasons
from clepsydra.scores.score import in_sentence
from clepsydra.studies.case_words import cases_sentence
from clepsydra.studies.ranking import QUIET
from clepsydra.studies.ranking_words import TIE, trust_sentence
from clepsydra.studies.recommendation import Recommendation, recommend, watched
from clepsydra.studies.result import Candidate, Standing, StudyResult
from clepsydra.studies.worst_case import least_trusted_case

#: Of the answer: rows of settings, and warnings.
_SETTINGS, _WATCHED = 3, 2
_MORE = "{} more rows: in the report"
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
        parts += advised(result, advice, why=why)
    if result.cases and result.ranking:
        parts += _in_cases(result, advice, every=every)
    if result.ranking and (every or not result.cases):
        listed_rows = result.ranking if every else _first(result, advice)
        shown = ranking_glance(listed_rows, result.times_limit)
        parts += [_EMPTY, replace(shown, kept=0) if every else shown]
    alarms = alarms_of_study(result.ranking) if every else None
    parts += [] if alarms is None else [_EMPTY, alarms]
    rest, narrow = (_rest(result, every, why, refused, columns) for columns in ("", "{}"))
    parts += [Line(rest, narrow=narrow)] if narrow else []
    if why:
        parts += _reasons(result, advice)
    if refused or not result.ranking:
        named = [f"{name} does not apply: {reason}" for name, reason in result.not_applicable]
        named += [
            f"{name} does not apply in the case {case}: {reason}"
            for case, found in result.cases.items()
            for name, reason in found.not_applicable
            if (name, reason) not in result.not_applicable
        ]
        parts += [_EMPTY, *marked(Mark.REFUSED, named)]
    if advice is not None:
        parts += [_EMPTY, *_commands(result, advice)]
    elif result.ranking:
        step = "Next: open the report, and change the process or its sampling."
        if any(case.settings == "frozen" for case in result.cases.values()):
            step = 'Next: where it fails, try settings = "designed_anew", or leave that case out.'
        parts += [_EMPTY, Line(step, Mark.NEXT)]
    return Section("", tuple(parts))


def _told_first(result: StudyResult, advice: Recommendation | None) -> Candidate:
    """Return the recommended controller, or the least bad."""
    return result.ranking[0] if advice is None else advice.simplest


def _in_cases(
    result: StudyResult, advice: Recommendation | None, *, every: bool
) -> list[Line | Table | Section]:
    """Return what the recommended controller, or the least bad, does in each case, and others."""
    first = _told_first(result, advice)
    words = cases_sentence(result, first)
    parts: list[Line | Table | Section] = [Line(words), _EMPTY, case_by_case(result, first)]
    for settings in settings_anew(result, first):
        parts += [_EMPTY, first_rows(settings, _SETTINGS, _MORE)]
    if len(result.ranking) > 1:
        shown = result.ranking if every else _first(result, advice)
        parts += [_EMPTY, error_in_cases(result, shown)]
    return parts


def advised(
    result: StudyResult, advice: Recommendation, *, why: bool
) -> list[Line | Table | Section]:
    """Return how good the recommended controller is, its settings, and what to watch."""
    process, simplest, best = result.process, advice.simplest, advice.best
    parts: list[Line | Table | Section] = []
    words = performance_words(process, simplest)
    said = [f"It {words}."] if words else []
    parts.append(Line(" ".join([*said, trust_sentence(simplest)])))
    loops = settings_table(simplest.controller, process)
    settings = [loops and _action_once(loops), added_table(simplest.controller, process)]
    tables = [first_rows(each, _SETTINGS, _MORE) for each in settings if each is not None]
    parts += [_EMPTY, *tables] if tables else []
    parts += [Line(words)] if (words := limit_words(result, simplest)) else []
    parts += [Line(words)] if (words := alarm_words(simplest.run)) else []
    parts += watch_lines(result, simplest, every=why)
    if best is not simplest:
        parts.append(Line(better_words(advice)))
    return parts


def _action_once(settings: Table) -> Table:
    """Return settings with the action of all loops in the head, where it is the same."""
    actions = {row[-1] for row in settings.rows}
    if settings.head[-1] != "action" or len(actions) > 1:
        return settings
    head = (f"ISA settings, {actions.pop()} action", *settings.head[1:-1])
    return replace(settings, head=head, rows=tuple(row[:-1] for row in settings.rows))


def better_words(advice: Recommendation) -> str:
    """Return what the best controller gains and needs beside the simplest, and what speaks against.

    Examples
    --------
    A third less error, for a model and further sensors:

    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.study(plant, [cl.design.lambda_(plant), cl.design.lqi(plant)])
    >>> better_words(recommend(found.ranking, accept=3.0))[25:]
    's 36 % less error; it also measures level_1 and level_2.'
    """
    controller = advice.best.controller
    if advice.saved < TIE - 1.0:
        return f"{controller.name} is first in the ranking, by less than 2 %."
    if not controller.setpoints:
        needs = "; it switches at levels, and holds no setpoint"
    elif controller.further_measurements:
        needs = f"; it also measures {listed(controller.further_measurements)}"
    elif controller.complexity is not advice.simplest.controller.complexity:
        needs = f"; it needs {controller.complexity.words}"
    else:
        needs = ""
    said = advice.best.warnings if needs else watched(advice.best)
    watch = f"; {in_sentence(said[0].brief)}" if said else "."
    at_worst = " in the worst case" if advice.best.cases else ""
    saved = f"has {100.0 * advice.saved:.0f} % less error{at_worst}"
    return f"The best, {controller.title}, {saved}{needs}{watch}"


def watch_lines(
    result: StudyResult, candidate: Candidate, *, every: bool = False
) -> tuple[Line, ...]:
    """Return what to watch with a controller and its run; the first of it, and how much more.

    What to do stands beside it where all is told, else it comes with the rest.
    """
    # The answer has told what is out of reach; what to do about it is told with the rest.
    told = () if every else result.out_of_reach
    warnings = [each for each in (*result.warnings, *watched(candidate)) if each not in told]
    found = [(each.brief, each.advice) for each in warnings]
    for caveat in candidate.caveats:
        if caveat.seen:
            shared = [any(c.about == caveat.about for c in each.caveats) for each in result.ranking]
            where = "every" if all(shared) and len(shared) > 1 else "this"
            brief, full = (in_sentence(each) for each in (caveat.words.brief, caveat.words.advice))
            found.append((f"In {where} run: {brief}", f"In {where} run: {full}"))
    more = 0 if every else len(found) - _WATCHED
    said = [brief for brief, _ in found[:_WATCHED]] if more > 0 else [full for _, full in found]
    said += [f"{more} more to watch, and what to do: --why."] if more > 0 else []
    return marked(Mark.WATCH, said)


def _first(result: StudyResult, advice: Recommendation | None) -> Sequence[Candidate]:
    """Return the first of the ranking, with the recommended one in the last row if it is later."""
    shown = result.ranking[:RANKED]
    if advice is None or advice.simplest in shown:
        return shown
    return (*shown[:-1], advice.simplest)


def _rest(result: StudyResult, every: bool, why: bool, refused: bool, columns: str) -> str:
    """Return what is not shown, and the option that shows it; with columns where some are lost."""
    more = len(result.ranking) - RANKED
    left = [f"{more} more rows" if columns else f"{more} more"] if more > 0 else []
    left += [columns if left else f"{columns} more"] if columns else []
    said = [f"{', '.join(left)}: --all"] if left and not every else []
    said += ["order, terms: --why"] if result.ranking and not why else []
    count = len(result.not_applicable)
    apply = "does not apply" if count == 1 else "do not apply"
    said += [f"{count} {apply}: --refused"] if count and not refused else []
    return "; ".join(said)


def _reasons(result: StudyResult, advice: Recommendation | None) -> list[Line | Table | Section]:
    parts: list[Line | Table | Section] = [_EMPTY]
    for each, words in zip(result.ranking, reasons(result.ranking), strict=True):
        parts.append(Line(f"{each.rank}  {each.controller.title}: {words}"))
    for each in result.ranking:
        titled = (f"{each.controller.title}: {words}" for words in each.warnings)
        parts += marked(Mark.WATCH, titled)
    parts += marked(Mark.WATCH, (*result.warnings, *result.caveats))
    if result.cases and result.ranking:
        parts += marked(Mark.WATCH, watched_in_cases(result, _told_first(result, advice)))
    return [*parts, _EMPTY, *ranking_notes(result)]


#: What a plant cannot run as it is, and what would do.
_NOT_EXPORTED = "A law in Python is not exported; one of expressions is, by step_law."


def _commands(result: StudyResult, advice: Recommendation) -> tuple[Line, ...]:
    subject = str(result.path or result.process.address)
    subject = f'"{subject}"' if " " in subject else subject
    chosen = advice.simplest.controller
    controller = f'--controller "{chosen.name}"'
    if isinstance(chosen.law, PythonLaw):
        drawn = f"Next: clepsydra draw {subject} {controller}"
        return (Line(_NOT_EXPORTED), *marked(Mark.COMMAND, (drawn,)))
    exported = f"Next: clepsydra export {subject} {controller} --to st"
    return marked(Mark.COMMAND, (exported, f"      clepsydra verify {subject} {controller}"))


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
        better = better_words(advice)
        if why.startswith("the best"):
            better = better.replace("The best,", "The best of all,")
        said.append(better)
    said += [cases_sentence(result, advice.simplest)] if result.cases else []
    said += [words] if (words := limit_words(result, advice.simplest)) else []
    said += [words] if (words := drawn_words(advice.simplest)) else []
    return " ".join(said)


def counted_words(result: StudyResult) -> str:
    """Return how many controllers ran, and how many of them are within all limits."""
    ran = len(result.ranking)
    good = sum(each.standing is Standing.ROBUST for each in result.ranking)
    refused = len(result.not_applicable)
    where = f" in {len(result.cases) + 1} cases" if result.cases else ""
    words = f"{ran} controller{'' if ran == 1 else 's'} ran{where}, {good} within all limits"
    return f"{words}, {refused} not applicable" if refused else words


def cards(result: StudyResult, compared: Sequence[Candidate]) -> list[Section]:
    """Return of the first candidate settings, how good, how sure and what to watch."""
    process, first = result.process, compared[0]
    found = [_settings(result, first), _how_good(process, compared), _how_sure(process, first)]
    lines = watch_lines(result, first, every=True)
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
        table = first_rows(replace(table, head=("", *table.head[1:])), _LOOPS, "{} more")
    added = added_table(controller, result.process)
    tables = (table,) if added is None else (table, added)
    return Section("Settings", (*tables, Line(f"ISA form, every {period}.")))


def _how_good(process: Process, compared: Sequence[Candidate]) -> Section:
    rows = []
    for figure in figures_of(process):
        cells = [figure.cell(process, each) for each in compared]
        if figure.score != "noise_movement" and set(cells) != {"–"}:
            worst = {found[0] for each in compared if (found := figure.worst(process, each))}
            of = f" ({worst.pop()})" if len(worst) == 1 and len(process.controlled) > 1 else ""
            rows.append((f"{figure.title}{of}", *cells))
    rows.append(("relative error", *(number_text(each.relative_error) for each in compared)))
    head = ("", *(each.controller.title for each in compared))
    return Section("How good", (Table("", head, tuple(rows)),))


def _how_sure(process: Process, first: Candidate) -> Section:
    where = f"in the worst case, {least_trusted_case(first).name}" if first.cases else ""
    rows = [("standing", standing_word(first), where)]
    if not math.isnan(peak := first.maximum_sensitivity):
        rows.append(("max|S|", number_text(peak), f"limit {SENSITIVITY_LIMIT:g}"))
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
        numbers = [math.inf if each is None else figure.compared(process, *each) for each in worst]
        texts = [figure.cell(process, each) for each in ranking]
        columns.append(RankingColumn(figure.title, tuple(zip(texts, numbers, strict=True))))
    criteria = ranking[0].criteria if ranking and len(ranking[0].criteria) > 1 else ()
    for title, values in (
        *((f"{name}, × best", [each.criteria[name] for each in ranking]) for name in criteria),
        ("relative error", [each.relative_error for each in ranking]),
        ("total variation, × least", [each.wear for each in ranking]),
        ("max|S|", [each.maximum_sensitivity for each in ranking]),
        (TIMES, [math.nan if t is None else t for t in map(result.times_limit, ranking)]),
    ):
        cells = [(number_text(value), math.inf if math.isnan(value) else value) for value in values]
        columns.append(RankingColumn(title, tuple(cells)))
    drawn = [(worst_cell(each), worst_compared(each)) for each in ranking]
    columns.append(RankingColumn(worst_head(ranking), tuple(drawn)))
    return [column for column in columns if {text for text, _ in column.cells} - {"–"}]
