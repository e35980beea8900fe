"""The noise of a scenario by what it is made of, which takes no room in a page."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from clepsydra.base.signal import path
from clepsydra.engine.white_noise import words_of
from clepsydra.loop.scenario import Scenario
from clepsydra.process.process import Process


def noise_apart(scenario: Scenario, process: Process) -> tuple[Scenario, dict[str, Any]]:
    """Return a scenario without its noise, and the noise of each input of a loop that has some.

    A scenario whose noise was given by its values keeps it.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant))
    >>> quiet, noises = noise_apart(run.scenario, run.process)
    >>> bool(quiet.noise.any()), [*noises][:2]
    (False, ['level_1.noise', 'level_2.noise'])
    """
    if scenario.quiet_disturbances is None:
        return scenario, {}
    measured = {signal.name for signal in process.measurements}
    noises = {
        path(each.signal, "noise") if each.signal in measured else each.signal: {
            "seed": list(words_of(scenario.seed)),
            "stream": each.stream,
            "first": each.first,
            "count": each.count,
            "deviation": each.deviation,
        }
        for each in scenario.noises
    }
    quiet = replace(
        scenario,
        noise=np.zeros_like(scenario.noise),
        disturbances=scenario.quiet_disturbances,
    )
    return quiet, noises
