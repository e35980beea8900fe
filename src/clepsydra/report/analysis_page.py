"""The page of a linear analysis: one HTML file that opens anywhere, without a script."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_type
from clepsydra.base.section import Line, Mark, Picture, Section, Table, marked
from clepsydra.linear.analysis import Analysis
from clepsydra.report.analysis_tables import analysis_grids, further_grids, operating_point_grid
from clepsydra.report.bode import bode_figure
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.nyquist import nyquist_figure
from clepsydra.report.page import page_text, write_page
from clepsydra.report.roots_picture import roots_figure
from clepsydra.report.singular_value_picture import directionality_figure
from clepsydra.report.step_picture import step_figure
from clepsydra.report.svg import svg_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Identifier, title, words, and drawn by.
_PICTURES: tuple[tuple[str, str, str, Callable[[Analysis], Figure]], ...] = (
    (
        "steps",
        "Step responses of the linear model",
        "Deviations from the operating point after a step of one input, the others held. A "
        "dotted line marks the end of the dead time.",
        step_figure,
    ),
    (
        "roots",
        "Poles and zeros",
        "Crosses are poles, circles transmission zeros; the right half-plane is shaded.",
        roots_figure,
    ),
    (
        "bode",
        "Frequency response",
        "Magnitude and phase from each input to each output; dotted lines stand at the rates of "
        "the poles. Dead time is exact.",
        bode_figure,
    ),
    (
        "nyquist",
        "Nyquist",
        "The same in the complex plane, in shares of the ranges; small numbers are frequencies "
        "[rad/s]. Dashed: the unit circle; the cross stands at −1.",
        nyquist_figure,
    ),
    (
        "directions",
        "Strong and weak directions, and interaction",
        "Singular values from shares of the inputs' ranges to shares of the outputs' ranges: the "
        "strongest direction dark, weaker ones grey; below one (dashed) a full swing of the "
        "inputs does not cover the range of the outputs. Relative gains of the suggested pairs "
        "are solid; near one the loops do not feel each other.",
        directionality_figure,
    ),
)

_FURTHER = (
    "Reached and shown: the smallest singular value of the test of Popov, Belevitch and Hautus in "
    "shares of the ranges; near one is well, zero not at all. σ: singular values from shares of "
    "the inputs' ranges to shares of the outputs' ranges."
)


def write_analysis_page(analysis: Analysis, path: str | Path) -> None:
    """Write the page of an analysis; an existing file is replaced only by a whole one.

    Parameters
    ----------
    analysis : Analysis
    path : str or Path
        An HTML file.

    Raises
    ------
    InputError
        It is no analysis, or the folder cannot be written to.

    Examples
    --------
    >>> import clepsydra as cl, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_analysis_page(cl.load("three-tanks").analysis, Path(folder, "a.html"))
    ...     Path(folder, "a.html").read_text("utf-8").count("<svg")
    6
    """
    require_type(
        analysis, Analysis, "report, analysis", "an Analysis", "give what analyse returned"
    )
    require_type(path, (str, Path), "report, path", "a file name", 'write as in "analysis.html"')
    write_page(analysis_page_text(analysis), path)


def analysis_page_text(analysis: Analysis) -> str:
    """Return the page of an analysis as HTML.

    Examples
    --------
    See `write_analysis_page`.
    """
    point = analysis.operating_point
    pictures = [
        Section(title, (Picture(svg_text(draw(analysis), title, name), words),))
        for name, title, words, draw in _PICTURES
    ]
    at_rest: tuple[Picture | Table, ...] = (
        Picture(process_drawing(point.process, point)),
        operating_point_grid(point),
        *analysis_grids(analysis),
    )
    return page_text(
        Section(
            f"{point.process.title or point.process.name} – linear analysis",
            (
                *marked(Mark.POINT, analysis.words),
                *marked(Mark.WATCH, point.warnings),
                Section("The process at its operating point", at_rest),
                *pictures,
                Section(
                    "Directions, modes and frequencies",
                    (*further_grids(analysis), Line(_FURTHER)),
                ),
            ),
        )
    )
