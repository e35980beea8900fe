"""The report of a study: one HTML file that opens anywhere, without a network or a script."""

from __future__ import annotations

import platform
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.base.files import whole_file
from clepsydra.report.analysis_tables import Grid, analysis_grids, operating_point_grid
from clepsydra.report.colours import signal_colours
from clepsydra.report.controller_tables import (
    ParameterTable,
    parameter_tables,
    status_words,
    wiring,
)
from clepsydra.report.drawing import process_drawing
from clepsydra.report.loop_picture import loop_figure
from clepsydra.report.margin_tables import margin_grid
from clepsydra.report.panels import all_panels, controlled_panels
from clepsydra.report.pid_tables import LoopSettings, loop_settings
from clepsydra.report.quantities import short_text
from clepsydra.report.score_tables import (
    RANKING_NOTE,
    ScoreTable,
    is_recommended,
    ranking_columns,
    ranking_rows,
    score_tables,
)
from clepsydra.report.svg import svg_text
from clepsydra.report.template import rendered
from clepsydra.report.trends import segment_words, trend_figure
from clepsydra.study.result import Candidate, StudyResult


@dataclass(frozen=True)
class _Page:
    """What the template shows of one controller."""

    candidate: Candidate
    loops: list[LoopSettings]
    margins: Grid | None
    parameters: list[ParameterTable]
    wiring: list[tuple[str, str]]
    scores: list[ScoreTable]
    status: list[str]
    picture: str
    loop_picture: str


def write_report(result: StudyResult, path: str | Path) -> None:
    """Write the report of a study; an existing file is replaced only by a whole one.

    Parameters
    ----------
    result : StudyResult
    path : str or Path
        An HTML file. Two reports of one result are equal byte for byte.

    Raises
    ------
    InputError
        The result is none of a study, or the folder cannot be written to.

    Examples
    --------
    >>> import tempfile
    >>> from clepsydra.study.study import run_study
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_report(run_study("quadruple-tank"), Path(folder, "study.html"))
    ...     Path(folder, "study.html").read_text("utf-8")[:15]
    '<!DOCTYPE html>'
    """
    require_type(
        result, StudyResult, "report, result", "a StudyResult", "give what run_study returned"
    )
    require_type(path, (str, Path), "report, path", "a file name", 'write as in "report.html"')
    text = report_text(result)
    with whole_file(Path(path)) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def report_text(result: StudyResult) -> str:
    """Return the report of a study as HTML.

    Everything from the user's files is escaped by the template; only pictures, which escape
    their own words, are put in as they are.

    Examples
    --------
    >>> from clepsydra.study.study import run_study
    >>> result = run_study("quadruple-tank")
    >>> result.verdict in report_text(result)
    True
    """
    from markupsafe import Markup

    first = result.ranking[0] if result.ranking else None
    overview = ""
    if first is not None:
        figure = trend_figure(first.run, controlled_panels(first.run))
        overview = svg_text(figure, f"Controlled levels under {first.controller.name}", "overview")
    return rendered(
        "report.html.jinja",
        result=result,
        best=first,
        recommended=is_recommended(result),
        overview=Markup(overview),
        drawing=Markup(process_drawing(result.process, result.point)),
        columns=ranking_columns(result),
        note=RANKING_NOTE,
        rows=ranking_rows(result),
        operating_point=operating_point_grid(result.point),
        grids=analysis_grids(result.analysis),
        pages=[_page(result, place) for place in range(len(result.ranking))],
        colours=signal_colours(result.process),
        computation=_computation(result),
        segments=_segments(result),
        picture=Markup,
    )


def _page(result: StudyResult, place: int) -> _Page:
    candidate = result.ranking[place]
    figure = trend_figure(candidate.run, all_panels(candidate.run))
    title = f"Levels, manipulated variables and disturbances under {candidate.controller.name}"
    response = candidate.response
    margins, loop_picture = None, ""
    if response is not None:
        margins = margin_grid(response)
        words = f"Loops and sensitivity of {candidate.controller.name}"
        loop_picture = svg_text(loop_figure(response, result.process), words, f"loop{place + 1}")
    return _Page(
        candidate,
        loop_settings(candidate.controller),
        margins,
        parameter_tables(candidate.controller),
        wiring(candidate.controller),
        score_tables(result.process, candidate),
        status_words(candidate.run),
        svg_text(figure, title, f"run{place + 1}"),
        loop_picture,
    )


def _computation(result: StudyResult) -> list[tuple[str, str]]:
    """Return how the numbers came about, as (what, how)."""
    scenario = result.scenario
    rows = [
        ("process file", str(result.process.path or f"{result.process.name} (catalogue)")),
        ("source of the numbers", result.process.source),
        ("sampling period", f"{short_text(scenario.sampling_period)} s"),
        ("samples", str(scenario.samples)),
        ("seed of the noise", str(scenario.seed)),
    ]
    for candidate in result.ranking:
        run = candidate.run
        solver = "reference solver"
        if run.substeps:
            solver = f"Runge-Kutta of order 4, steps in a sample: {run.substeps}"
        error = "not estimated"
        if run.error_estimate is not None:
            error = f"{run.error_estimate:.1e} of the state's range, by step halving"
        rows.append((f"integration, {candidate.controller.name}", f"{solver}; error {error}"))
    rows.append(("versions", versions_text()))
    return rows


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


def _segments(result: StudyResult) -> Grid:
    rows = []
    for segment in result.scenario.segments:
        words = segment_words(result.process, segment)
        times = f"{short_text(segment.start)} – {short_text(segment.stop)}"
        rows.append((f"{words[0]} {words[1]}", times, words[2]))
    return Grid("Scenario", ("what happens", "time [s]", "size"), tuple(rows))
