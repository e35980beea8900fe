"""Caveats of averaging levels that are still on their way when a segment of the scenario ends."""

from __future__ import annotations

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.studies.warnings.caveat import Caveat

#: Part of a segment, its last, in which a level at rest does not move any more.
_LAST = 0.1
#: A level that moves less in it, as a share of the way that it went in the segment, is at rest.
_AT_REST = 0.01
#: And one that went less than this share of its range has not moved.
_NO_WAY = 1e-6


def unfinished_caveats(run: Run) -> list[Caveat]:
    """Return which averaging levels are not at rest at the end of a step's segment.

    That such a level is away from its setpoint is no fault. But where it still moves by more
    than 1 % of its way in the last tenth of the segment, the segment is shorter than what its
    loop takes, an arrest time, say: the next step begins before the last one is over, and
    scores are of a part of the response. Of each level the first such segment is told.
    """
    found = []
    for name in run.process.averaging:
        if name not in run.controller.setpoints:
            continue
        for segment in run.scenario.segments:
            share = _still_moving(name, segment, run) if segment.kind != "noise" else 0.0
            if share > _AT_REST:
                what = (
                    f"{name} is not at rest when the {segment.kind} step of {segment.signal} ends "
                    f"after {time_text(segment.stop - segment.start)}"
                )
                words = (
                    f"{what}: in the last tenth it still moves by {100.0 * share:.2g} % of its "
                    "way, so that its scores are of a part of the response; leave more time "
                    "between the steps, in a study file."
                )
                found.append(Caveat(words, what, share))
                break
    return found


def _still_moving(name: str, segment: Segment, run: Run) -> float:
    """Return the way in the last tenth of a segment as a share of the way in the whole of it."""
    period = run.scenario.sampling_period
    within = run.true_measurement(name)[
        round(segment.start / period) : round(segment.stop / period)
    ]
    if len(within) < 2:
        return 0.0
    way = float(np.ptp(within))
    late = within[-max(2, round(_LAST * len(within))) :]
    nothing = _NO_WAY * run.process.signal(name).span
    return float(np.ptp(late)) / way if way > nothing else 0.0
