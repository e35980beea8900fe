"""The report of a study: one HTML file that opens anywhere, without a network."""

from __future__ import annotations

import platform
from importlib import metadata
from pathlib import Path

from clepsydra.base.arguments import require_type
from clepsydra.base.files import whole_file
from clepsydra.base.section import Table
from clepsydra.base.words import time_text
from clepsydra.controllers.blocks.status import STATUS_BITS
from clepsydra.process.process import Process
from clepsydra.report.analysis_tables import analysis_grids, operating_point_grid
from clepsydra.report.colours import signal_colours
from clepsydra.report.controller_page import controller_page
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.map_picture import map_svg
from clepsydra.report.page_assets import STILL_WORDS, page_assets
from clepsydra.report.panels import controlled_panels
from clepsydra.report.resolution import RESOLUTION_WORDS
from clepsydra.report.score_tables import (
    glossary,
    ranking_columns,
    ranking_note,
    ranking_rows,
)
from clepsydra.report.study_answer import advised
from clepsydra.report.template import rendered
from clepsydra.report.trend_data import trend_data
from clepsydra.report.trend_svg import trend_svg
from clepsydra.report.trends import segment_words
from clepsydra.studies.recommendation import recommend
from clepsydra.studies.result import StudyResult


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
    >>> import clepsydra as cl, tempfile
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)], duration="1 min")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_report(result, Path(folder, "study.html"))
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
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)], duration="1 min")
    >>> result.verdict in report_text(result)
    True
    """
    from markupsafe import Markup

    advice = recommend(result.ranking, result.accept)
    first = next(iter(result.ranking), None) if advice is None else advice.simplest
    assets = page_assets()
    overview, trends = "", {}
    if first is not None:
        title = f"Controlled levels under {first.controller.title}"
        panels = controlled_panels(first.run)
        overview, trends = (
            trend_svg(first.run, panels, title, "overview"),
            trend_data(first.run, panels),
        )
    return rendered(
        "report.html.jinja",
        result=result,
        best=first,
        recommended=None if advice is None else first,
        advised=[] if advice is None else advised(result, advice),
        overview=Markup(overview),
        assets=assets,
        trends=trends,
        still_words=STILL_WORDS,
        map=Markup(map_svg(result, "Mean error and max|S| of every controller", "map")),
        drawing=Markup(process_drawing(result.process, result.point)),
        columns=ranking_columns(result),
        note=ranking_note(result),
        rows=ranking_rows(result),
        operating_point=operating_point_grid(result.point),
        grids=analysis_grids(result.analysis),
        pages=[controller_page(result, place) for place in range(len(result.ranking))],
        glossary=glossary(result),
        status_bits=[(bit.value, bit.meaning) for bit in STATUS_BITS.values()],
        colours=signal_colours(result.process),
        computation=_computation(result),
        segments=_segments(result),
        resolution=RESOLUTION_WORDS,
        picture=Markup,
    )


def _computation(result: StudyResult) -> list[tuple[str, str]]:
    """Return how the numbers came about, as (what, how)."""
    scenario = result.scenario
    rows = [
        *([] if result.path is None else [("study file", str(result.path))]),
        ("process file", address_text(result.process)),
        ("source of the numbers", result.process.source),
        ("sampling period", time_text(scenario.sampling_period, 4)),
        ("samples", str(scenario.samples)),
        ("seed of the noise", str(scenario.seed)),
    ]
    solvers: dict[str, list[str]] = {}
    for candidate in result.ranking:
        run = candidate.run
        solver = "reference solver"
        if run.substeps:
            solver = f"Runge-Kutta of order 4, steps in a sample: {run.substeps}"
        error = "not estimated"
        if run.error_estimate is not None:
            error = f"{run.error_estimate:.1e} of the state's range, by step halving"
        solvers.setdefault(f"{solver}; error {error}", []).append(str(candidate.rank))
    for words, ranks in solvers.items():
        rows.append((f"integration, controller {', '.join(ranks)}", words))
    rows.append(("versions", versions_text()))
    return rows


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
    rows = []
    for segment in result.scenario.segments:
        words = segment_words(result.process, segment)
        times = " – ".join(time_text(time, 4) for time in (segment.start, segment.stop))
        rows.append((f"{words[0]} {words[1]}", times, words[2]))
    return Table("Scenario", ("what happens", "time", "size"), tuple(rows))
