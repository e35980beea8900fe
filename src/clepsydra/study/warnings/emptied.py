"""Warnings of tanks that ran empty in a run, which harms nothing where nothing is pumped."""

from __future__ import annotations

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.loop.run import Run
from clepsydra.study.warnings.harm import BREAKS_OFF
from clepsydra.study.warnings.words import shown


def emptied_warnings(run: Run) -> list[str]:
    """Return which levels came down to the floor, and when; one below it is a harm of its own.

    Parameters
    ----------
    run : Run

    Examples
    --------
    See `clepsydra.study.warnings.harm.harms` for a run; one without empty tanks has no warning.
    """
    words = []
    for x in run.process.state:
        if x.name in run.process.levels:
            level = run.values[x.name]
            empty = level <= x.low + EMPTY_SHARE * (x.high - x.low)
            if np.any(empty) and not np.any(level < x.low):
                words.append(
                    f"{x.name} runs empty at {time_text(run.time[int(np.argmax(empty))])} (range "
                    f"{shown(x.low, x)} to {shown(x.high, x)}): {BREAKS_OFF}."
                )
    return words
