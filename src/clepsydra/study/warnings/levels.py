"""Warnings of levels that left their tanks in a run, and whether they did."""

from __future__ import annotations

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.loop.run import Run
from clepsydra.study.warnings.words import shown


def leaves_its_tanks(run: Run) -> bool:
    """Return whether a level leaves its tank or a state stops being a number.

    Examples
    --------
    >>> from clepsydra.design.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> leaves_its_tanks(Loop(controller, analysis.model).run(default_scenario(analysis.model)))
    False
    """
    process = run.process
    within = all(
        np.all((run.values[x.name] >= x.low) & (run.values[x.name] <= x.high))
        for x in process.state
        if x.name in process.levels
    )
    return not within or any(not np.all(np.isfinite(run.values[x.name])) for x in process.state)


def overflow_warnings(run: Run) -> list[str]:
    """Return which levels rose above their rim, ran empty or stopped being numbers, and when.

    Parameters
    ----------
    run : Run

    Examples
    --------
    See `leaves_its_tanks` for a run; one that stays in its tanks has no warning.
    """
    words = []
    totals = {total.name for total in run.process.motion.totals}
    for x in run.process.state:
        level = run.values[x.name]
        limits = [
            (
                np.isnan(level),
                "is not a number",
                "the loop has diverged, and nothing after that counts; lower the gains",
            )
        ]
        if x.name in run.process.levels:
            spills = f"{x.name.removesuffix('level')}spilt" in totals
            lost = (
                "it spills; make the step smaller or the gain larger"
                if spills
                else "the model spills nothing, since it has no weir, and the rest of the run "
                "holds for a higher tank only"
            )
            empty = level <= x.low + EMPTY_SHARE * (x.high - x.low)
            limits.append((level > x.high, "rises above its rim", lost))
            limits.append((empty, "runs empty", "what is drawn from it breaks off"))
        for where, what, consequence in limits:
            if np.any(where):
                words.append(
                    f"{x.name} {what} at {time_text(run.time[int(np.argmax(where))])} (range "
                    f"{shown(x.low, x)} to {shown(x.high, x)}): {consequence}."
                )
    return words
