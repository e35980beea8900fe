"""Checked runs of several loops of one law, side by side as lanes of one kernel."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from clepsydra.engine.kernel import Kernel
from clepsydra.loop.law_begin import loop_begin
from clepsydra.loop.loop import Loop
from clepsydra.loop.motion_block import steps_told
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.step_size import LARGEST_REFINEMENT

#: Two vectors of eight numbers take half as long again as one.
_LANES = 16
#: Loops whose three runs each have room in them.
TOGETHER = _LANES // 3


def run_alike(one: Loop, other: Loop, scenario: Scenario) -> bool:
    """Return whether two loops can run side by side in a scenario: they differ in numbers alone."""
    if not (one.side_by_side and other.side_by_side) or scenario.begin is not None:
        return False
    return one.refining_kernel(scenario) is other.refining_kernel(scenario)


def checked_runs(
    loops: Sequence[Loop], scenario: Scenario, largest: int = LARGEST_REFINEMENT
) -> list[Run]:
    """Simulate several loops as `Loop.run_checked` does each, with the same bits.

    Parameters
    ----------
    loops : sequence of Loop
        Which `run_alike`; up to `TOGETHER` of them take half as long again as one.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> plant = cl.load("three-tanks")
    >>> pair = [Loop(made(plant), plant.linear) for made in (cl.design.simc, cl.design.amigo)]
    >>> scenario = default_scenario(plant.linear)
    >>> first, second = checked_runs(pair, scenario)
    >>> first.error_estimate == pair[0].run_checked(scenario).error_estimate
    True
    """
    first, begins = loops[0], [loop_begin(loop, scenario, 1)[0] for loop in loops]
    first.check(scenario)
    count = first.first_count(scenario)
    counts = [count, 2 * count, 4 * count]
    own = [loop.law_parameters() for loop in loops]
    told = steps_told(first.process.sampling_period, counts * len(loops))
    result = _wide(first.refining_kernel(scenario), first.fuse).run(
        scenario.samples,
        inputs=first.inputs_of(scenario),
        state={name: np.repeat([each[name] for each in begins], 3) for name in begins[0]},
        parameters={name: np.repeat([each[name] for each in own], 3) for name in own[0]} | told,
        turns=counts[-1],
    )
    found = []
    for place, loop in enumerate(loops):
        made = [loop.run_of(scenario, result, 3 * place + k, n) for k, n in enumerate(counts)]
        found.append(loop.run_checked(scenario, largest, made))
    return found


@lru_cache(maxsize=8)
def _wide(kernel: Kernel, fuse: bool) -> Kernel:
    return Kernel(kernel.program, lanes=_LANES, fuse=fuse)
