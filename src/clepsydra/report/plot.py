"""One run as a Matplotlib figure, for a notebook or a paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_type
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.report.panels import all_panels
from clepsydra.report.trends import trend_figure
from clepsydra.studies.result import Candidate, StudyResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(run: Run | Simulation) -> Figure:
    """Draw everything that a run recorded: states, manipulated variables, disturbances, events.

    Parameters
    ----------
    run : Run or Simulation

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it; ``figure.savefig("run.pdf")`` writes it.

    Raises
    ------
    InputError
        It is no run; a whole study holds one for each controller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> step = [cl.step("level_1", "+0.5 V", at="10 s")]
    >>> figure = plot(cl.simulate(plant, cl.design.simc(plant), step, duration="1 min"))
    >>> len(figure.axes)  # the strip, four levels, two pumps
    7
    """
    remedy = "give one, as from Loop(controller, model).run(scenario)"
    if isinstance(run, StudyResult):
        remedy = "give result.ranking[0].run" if run.ranking else "no controller of it has a run"
    elif isinstance(run, Candidate):
        remedy = "give candidate.run"
    require_type(run, (Run, Simulation), "plot", "a Run or a Simulation", remedy)
    return trend_figure(run, all_panels(run))
