"""How far levels moved in a run, which another controller is not to exceed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.loop.run import Run


def levels_used(run: Run, measurements: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the band around its first value that the level behind each measurement kept [m].

    The band reaches as far down as up: a run whose loads only filled a tank says as much about
    the room below.

    Parameters
    ----------
    run : Run
        From the operating point.
    measurements : sequence of str
        Those of something else than a level are passed over.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.designs.arrest_time import design_arrest_time
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> model = cl.load("equalisation-tank").linear
    >>> run = Loop(design_arrest_time(model), model).run(default_scenario(model))
    >>> low, high = levels_used(run, ["level"])["basin.level"]
    >>> round(high + low, 9)  # the basin of 5 m is half full at first
    5.0
    """
    process = run.process
    found = {}
    for name in measurements:
        state = process.measured_state.get(name)
        if state in process.levels:
            level = run.values[state]
            room = float(np.max(np.abs(level - level[0])))
            if room > 0.0:
                found[state] = (float(level[0]) - room, float(level[0]) + room)
    return found
