"""One run as a Matplotlib figure, for a notebook or a paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.loop.run import Run
from clepsydra.report.panels import all_panels
from clepsydra.report.trends import trend_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(run: Run) -> Figure:
    """Draw everything that a run recorded: levels, manipulated variables, disturbances.

    Parameters
    ----------
    run : Run

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it; ``figure.savefig("run.pdf")`` writes it.

    Examples
    --------
    >>> from clepsydra.study.study import run_study
    >>> figure = plot(run_study("quadruple-tank").ranking[0].run)
    >>> len(figure.axes)  # the strip, four levels, two pumps, two inflows
    9
    """
    return trend_figure(run, all_panels(run))
