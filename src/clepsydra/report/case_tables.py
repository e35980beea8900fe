"""What controllers do in the cases of a study, as tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.report.case_picture import case_picture
from clepsydra.report.facts import facts_table, told_table
from clepsydra.report.figures import figures_of
from clepsydra.report.pid_tables import settings_table
from clepsydra.report.quantities import number_text
from clepsydra.report.ranking_rows import standing_word
from clepsydra.scores.score import in_sentence
from clepsydra.studies.case_words import cases_sentence, error_beside_base, times_text
from clepsydra.studies.recommendation import watched
from clepsydra.studies.result import BASE_CASE, Candidate, StudyResult

#: How the settings of a case are told, of which the usual ones need no word.
_SETTINGS = {"frozen": "", "designed_anew": "designed anew"}


def case_by_case(result: StudyResult, candidate: Candidate) -> Table:
    """Return what a controller does in each case, in physical numbers, a case a row.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> lower = plant.at(outputs={"level_1": "4 V", "level_2": "4 V"})
    >>> found = cl.study(plant, [cl.design.simc(plant)], cases={"low": lower})
    >>> case_by_case(found, found.best).head[:3]
    ('PI, SIMC', 'standing', 'error × base')
    """
    figures, rows = figures_of(result.process), []
    for name, there in candidate.cases.items():
        settings = "" if name == BASE_CASE else _SETTINGS[result.cases[name].settings]
        if there is None:
            rows.append((name, settings, "does not apply", *["–"] * (len(figures) + 2)))
            continue
        rows.append(
            (
                name,
                settings,
                standing_word(there),
                times_text(error_beside_base(candidate, name, result.judged_by)),
                *(figure.cell(there.run.process, there) for figure in figures),
                number_text(there.maximum_sensitivity),
            )
        )
    titles = (figure.title for figure in figures)
    head = (candidate.controller.name, "settings", "standing", "error × base", *titles)
    return told_table((*head, "max|S|"), rows)


def error_in_cases(result: StudyResult, shown: Sequence[Candidate]) -> Table:
    """Return the error of each controller in each case beside the best there, and its worst.

    Where it is not robust its standing stands in the place of the error.
    """
    names = (BASE_CASE, *result.cases)
    rows = [
        (
            str(each.rank),
            each.controller.name,
            *(_cell(each.cases[name]) for name in names),
            _cell(each),
        )
        for each in shown
    ]
    return Table("", ("", "error × best", *names, "worst"), tuple(rows), names=2)


def _cell(there: Candidate | None) -> str:
    """Return an error; of one that is not robust its standing, which counts before the error."""
    if there is None:
        return "does not apply"
    return standing_word(there) if there.standing else times_text(there.mean_error)


def settings_anew(result: StudyResult, candidate: Candidate) -> list[Table]:
    """Return the settings of the loops of a controller in each case for which it is designed."""
    found = []
    for name, case in result.cases.items():
        there = candidate.cases[name]
        if there is None or case.settings == "frozen":
            continue
        if settings := settings_table(there.controller, case.process):
            found.append(replace(settings, head=(name, *settings.head[1:])))
    return found


def watched_in_cases(result: StudyResult, candidate: Candidate) -> list[str]:
    """Return what there is to watch with a controller in a case and not in the base case."""
    told, found = {*result.warnings, *watched(candidate)}, []
    for name, case in result.cases.items():
        there = candidate.cases[name]
        said = [*case.warnings, *(() if there is None else watched(there))]
        found += [f"In the case {name}: {in_sentence(each)}" for each in said if each not in told]
    return found


def cases_section(result: StudyResult, first: Candidate) -> Section:
    """Return the cases of a study for a page: of the first controller, and of all of them."""
    picture = case_picture(result, first)
    parts: list[Line | Table | Picture | Section] = [
        Line(cases_sentence(result, first)),
        case_by_case(result, first),
        *([] if picture is None else [picture]),
        *marked(Mark.WATCH, watched_in_cases(result, first)),
        error_in_cases(result, result.ranking),
    ]
    parts += settings_anew(result, first)
    for name, case in result.cases.items():
        if further := [each for each in case.not_applicable if each not in result.not_applicable]:
            refused = facts_table("", further)
            parts.append(Section(f"Not applicable in the case {name}", (refused,), folded=True))
    return Section("Cases", tuple(parts))
