"""An operating point and what the linear model says about it, on a screen."""

from __future__ import annotations

from clepsydra.base.section import Line, Mark, Section, marked
from clepsydra.linear.analysis import Analysis
from clepsydra.report.analysis_tables import analysis_grids, operating_point_grid


def analysis_answer(analysis: Analysis) -> Section:
    """Return an operating point, its linear analysis in tables and words, and what comes next.

    Examples
    --------
    >>> import clepsydra as cl
    >>> analysis_answer(cl.load("quadruple-tank").analysis).title
    'Quadruple tank, minimum phase (quadruple-tank)'
    """
    point = analysis.operating_point
    process = point.process
    return Section(
        f"{process.title} ({process.name})",
        (
            operating_point_grid(point),
            *analysis_grids(analysis),
            *marked(Mark.POINT, analysis.words),
            *marked(Mark.WATCH, point.warnings),
            Line(""),
            Line(f"Next: clepsydra study {process.address}", Mark.COMMAND),
        ),
    )
