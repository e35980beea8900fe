"""The report of a study: one HTML file that opens anywhere, without a network."""

from __future__ import annotations

import json
import platform
from collections.abc import Sequence
from importlib import metadata
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.base.signal import path
from clepsydra.base.words import time_text, time_unit, with_minus
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.signals import owners
from clepsydra.process.process import Process
from clepsydra.program.called_blocks import without_untold
from clepsydra.program.owned_state import with_owned_state
from clepsydra.report.alarm_tables import alarms_of_run, alarms_of_study
from clepsydra.report.analysis_tables import analysis_grids, margin_grid, operating_point_grid
from clepsydra.report.case_tables import cases_section
from clepsydra.report.drawing.block_picture import program_svg
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.facts import facts_table
from clepsydra.report.law_tables import (
    law_facts,
    law_grids,
    law_words,
    parameter_tables,
    status_words,
)
from clepsydra.report.limit_answer import limit_sections
from clepsydra.report.live.live_data import live_data
from clepsydra.report.overlay import event_windows, overlay_data, sensitivity_data, shown_signals
from clepsydra.report.overlay_picture import overlay_svg
from clepsydra.report.page import STILL_WORDS, page_assets, rendered
from clepsydra.report.pid_tables import loop_settings
from clepsydra.report.quantities import RESOLUTION_WORDS, number_text, quantity_text
from clepsydra.report.ranking_rows import standing_word
from clepsydra.report.scheme_tables import scheme_blocks
from clepsydra.report.score_tables import glossary, ranking_notes, score_tables, tuning_grid
from clepsydra.report.study_answer import cards, counted_words, headline, lead, ranking_columns
from clepsydra.report.trends import segment_words
from clepsydra.studies.recommendation import Recommendation, recommend, rival_of
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.tuning.result import TuningResult


def report_text(result: StudyResult) -> str:
    """Return the report of a study as HTML.

    Everything from the user's files is escaped by the template; only pictures, which escape
    their own words, are put in as they are.
    """
    advice = recommend(result.ranking, result.accept)
    assets = page_assets()
    signals = shown_signals(result)
    first = _shown_first(result, advice)
    windows = event_windows(result, signals, first) if first else []
    data, still = "", ""
    live: dict[str, Any] | None = None
    if windows:
        shows = "What the first two controllers make of each event"
        still = overlay_svg(windows, signals, first, shows)
        overlay = overlay_data(result, signals, windows, first)
        if assets is not None:
            live = live_data(result, signals, windows, first)
        more = {"sensitivity": sensitivity_data(result.ranking), "live": live}
        data = json_text(overlay | more)

    controllers = [
        controller_section(result, each, with_blocks=each in first[:1]) for each in result.ranking
    ]
    cases = [cases_section(result, first[0])] if result.cases and first else []
    closing = first[0].controller if first else None
    name = result.title or result.process.title
    return rendered(
        "report.html.jinja",
        title=f"{name} – control study",
        name=name,
        counted=counted_words(result),
        headline=headline(result, advice),
        lead=lead(result, advice),
        cards=cards(result, first) if first else [],
        still=still,
        columns=ranking_columns(result),
        ranking=result.ranking,
        standing_word=standing_word,
        first=first,
        recommended=None if advice is None else advice.simplest,
        drawing=process_drawing(result.process, result.point, closing),
        details=[*cases, *limit_sections(result, first[:1]), *controllers, *_more(result)],
        assets=assets,
        still_words=STILL_WORDS,
        data=data,
        live=live is not None,
    )


def json_text(data: object) -> str:
    """Return data as JSON that may stand in a script element: no sign of it ends the element.

    Examples
    --------
    >>> json_text({"title": "</script>"})
    '{"title":"\\\\u003c/script>"}'
    """
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return text.replace("<", "\\u003c")


def _shown_first(result: StudyResult, advice: Recommendation | None) -> list[Candidate]:
    """Return the recommended controller, then the best beside it, or the next of the ranking."""
    if advice is None:
        return list(result.ranking[:2])
    other = advice.best if advice.best is not advice.simplest else rival_of(result.ranking)
    return [advice.simplest, *([] if other is None else [other])]


def _more(result: StudyResult) -> list[Section]:
    """Return what the process and the computation have to say, folded."""
    words = (*marked(Mark.POINT, result.analysis.words), *marked(Mark.WATCH, result.warnings))
    tables = (operating_point_grid(result.point), *analysis_grids(result.analysis))
    found = [Section("What the linear model says", (*words, *tables), folded=True)]
    if result.not_applicable:
        reasons = ((name, with_minus(reason)) for name, reason in result.not_applicable)
        refused = facts_table("", reasons)
        folded = bool(result.ranking)
        found.append(Section("Not applicable, and why", (refused,), folded=folded))
    if alarms := alarms_of_study(result.ranking):
        found.insert(0, alarms)
    bits = tuple((str(bit.value), bit.meaning) for bit in STATUS_BITS.values())
    meanings: tuple[Line | Table, ...] = (
        *ranking_notes(result),
        facts_table("Scores", glossary(result)),
        Line(RESOLUTION_WORDS),
        facts_table("Bits of the status word of an output", bits),
    )
    caveats = marked(Mark.WATCH, result.caveats)
    computed = facts_table("", _computation(result))
    return [
        *found,
        Section("What the numbers mean, and what decides the order", meanings, folded=True),
        Section("How this was computed", (computed, *caveats, _segments(result)), folded=True),
    ]


def _computation(result: StudyResult) -> list[tuple[str, str]]:
    """Return how the numbers came about, as (what, how)."""
    scenario = result.scenario
    file = [] if result.path is None else [("study file", str(result.path))]
    rows = [
        *file,
        ("process file", address_text(result.process)),
        ("source of the numbers", result.process.source),
        ("sampling period", time_text(scenario.sampling_period, 4)),
        ("samples", str(scenario.samples)),
        ("seed of the noise", str(scenario.seed)),
    ]
    solvers: dict[int, list[Candidate]] = {}
    for each in result.ranking:
        solvers.setdefault(each.run.substeps, []).append(each)
    for substeps, group in solvers.items():
        ranks = ", ".join(str(each.rank) for each in group)
        what = f"integration, controller {ranks}" if len(solvers) > 1 else "integration"
        errors = [each.run.error_estimate for each in group]
        rows.append((what, integration_words(substeps, errors)))
    rows.append(("versions", versions_text()))
    return rows


def integration_words(substeps: int, errors: Sequence[float | None]) -> str:
    """Return how runs were integrated, and how large their errors are at most.

    Examples
    --------
    >>> integration_words(4, [1e-9, 3e-9, None])
    "Runge-Kutta of order 4, steps in a sample: 4; error at most 3.0e-09 of the state's range, \
by step halving"
    >>> integration_words(0, [None])
    'reference solver to a relative tolerance of 1e−10; error not estimated'
    """
    known = [error for error in errors if error is not None]
    error = f"at most {max(known):.1e} of the state's range, by step halving" if known else ""
    if known and max(known) >= 1.0:
        error = "as large as the state's whole range, by step halving"
    solver = "reference solver to a relative tolerance of 1e−10"
    if substeps:
        solver = f"Runge-Kutta of order 4, steps in a sample: {substeps}"
    return f"{solver}; error {error or 'not estimated'}"


def address_text(process: Process) -> str:
    """Return where a process is from: its file, or the catalogue, with its variants.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> address_text(load_process("equalisation-tank:relief"))
    'equalisation-tank:relief (catalogue)'
    """
    return process.address if process.path else f"{process.address} (catalogue)"


def versions_text() -> str:
    """Return the versions of what a result was computed with.

    Examples
    --------
    >>> versions_text().startswith("Python 3.")
    True
    """
    packages = ("clepsydra", "casadi", "llvmlite", "numpy", "scipy", "matplotlib")
    versions = [f"{name} {version}" for name in packages if (version := _version(name))]
    return ", ".join([f"Python {platform.python_version()}", *versions])


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:  # run from a source tree that is not installed
        return ""


def _segments(result: StudyResult) -> Table:
    unit, length = time_unit(result.scenario.duration)
    begin, rows = result.scenario.begin, []
    if begin is not None:
        rows.append((f"begins {begin.words}, controllers {begin.controller_start}", "0", ""))
    for segment in result.scenario.segments:
        kind, signal, size = segment_words(result.process, segment)
        times = " – ".join(number_text(t / length) for t in (segment.start, segment.stop))
        rows.append((f"{kind} {signal}", times, size))
    return Table("Scenario", ("what happens", f"time [{unit}]", "size"), tuple(rows))


#: So many points of a front are listed at most.
_FRONT = 8


def controller_section(
    result: StudyResult, candidate: Candidate, *, with_blocks: bool = False
) -> Section:
    """Return what the report tells of a controller of its ranking, folded.

    Parameters
    ----------
    with_blocks : bool
        Whether with a picture of the blocks that are exported.
    """
    controller, process, tuning = candidate.controller, result.process, candidate.tuning
    grids = law_grids(controller, process)
    # What is told by the settings of loops or by matrices is not told again as parameters.
    rest = [] if grids or controller.law.blocks else parameter_tables(controller)
    settings = (
        *loop_settings(controller, result.point),
        *scheme_blocks(controller, process),
        *law_facts(controller, process),
        *grids,
        *rest,
        _wiring(controller),
    )
    robust: Line | Table = Line("There is no linear loop, and so no margin.")
    if candidate.response is not None:
        robust = margin_grid(candidate.response)
    behaved: list[Line | Table] = [*score_tables(process, candidate)]
    behaved += [Line(f"Status of {words}.") for words in status_words(candidate.run)]
    if tuning is not None:
        behaved.append(tuning_grid(tuning, process, result.scenario.duration))
        behaved += [_front(tuning)] if len(tuning.front.objective) > 1 else []
    parts: list[Line | Section] = [
        Line(candidate.reason),
        *marked(Mark.WATCH, candidate.warnings),
        Line(controller.design),
        *(Line(words) for words in (*controller.notes, *law_words(controller))),
        Section("Settings", settings),
        Section("How robust it is", (robust,)),
        Section("How it behaved", tuple(behaved)),
    ]
    if alarms := alarms_of_run(candidate.run):
        parts.append(Section("Its alarms", alarms))
    if with_blocks and (picture := _blocks(result, candidate)):
        parts.append(Section("The blocks of its export", (picture,), folded=True))
    return Section(f"{candidate.rank}. {controller.title}", tuple(parts), folded=True)


def _front(tuning: TuningResult) -> Table:
    """Return what robustness costs: the least objective that was found for each max|S|."""
    front = tuning.front
    chosen = np.linspace(0, len(front.objective) - 1, min(_FRONT, len(front.objective)))
    rows = [
        (number_text(front.sensitivity[place]), number_text(front.objective[place]))
        for place in np.unique(np.rint(chosen).astype(int))
    ]
    return Table("The best found for each max|S|", ("max|S|", "objective"), tuple(rows))


def _blocks(result: StudyResult, candidate: Candidate) -> Picture | None:
    """Return the picture of the blocks that a plant gets; None where nothing can be exported."""
    controller = candidate.controller
    try:
        shelled = with_plant_shell(controller, result.scenario.sampling_period)
    except InputError:  # a function in Python, or a law without what the shell needs
        return None
    title = f"Blocks of {controller.title} in their plant shell"
    program = without_untold(with_owned_state(shelled.program()))
    return Picture(
        program_svg(program, title),
        "Thick wires carry numbers, thin ones truth values; an open circle stands for operations "
        "before a port.",
    )


def _wiring(controller: Controller) -> Table:
    """Return what is connected to what."""
    law, free = controller.law, controller.free_inputs
    facts: list[tuple[str, str]] = []
    for part, ports, words, names in (
        ("pv", law.inputs, "", controller.measurements),
        ("sp", law.inputs, "setpoint of ", controller.setpoints),
        ("out", law.outputs, "", controller.manipulated),
    ):
        given = [port for owner in owners(ports, part) if (port := path(owner, part)) not in free]
        facts += zip(given, (f"{words}{name}" for name in names), strict=True)
    for entry in law.inputs:
        if entry.name in free:
            facts.append((entry.name, f"{quantity_text(entry, free[entry.name])} at rest"))
    return facts_table("Wiring", facts)
