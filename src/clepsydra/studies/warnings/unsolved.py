"""Samples in which a controller that searches found nothing."""

from __future__ import annotations

from collections.abc import Iterator

from clepsydra.base.remark import Remark
from clepsydra.controllers.wiring import controller_name
from clepsydra.loop.run import Run


def unsolved(run: Run) -> Iterator[Remark]:
    """Yield in how many samples of a run the search of its controller came to no end.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> list(unsolved(cl.simulate(plant, cl.design.simc(plant))))
    []
    """
    law, final = run.controller.law, run.final_state
    if not law.unsolved:
        return
    if count := round(final[controller_name(law.unsolved)]):
        yield Remark(
            f"in {count} of {run.scenario.samples} samples the search for the best inputs came to "
            "no end",
            "its fallback acted there",
            "look at the run there, or give the controller another horizon",
        )
