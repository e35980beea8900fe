"""Warnings of trips and of pumps that ran dry in a run."""

from __future__ import annotations

from clepsydra.base.words import time_text
from clepsydra.loop.happenings import happenings
from clepsydra.loop.run import Run

#: Parts of the names of events that no plant is meant to see; starts and stops are no fault.
_FAULTS = {
    ".trips_": "until it is released nothing is controlled; keep the levels away from it",
    ".runs_dry": "nothing is left to draw, which damages a pump; keep the level higher",
}


def happened_warnings(run: Run) -> list[str]:
    """Return what tripped or ran dry in a run: the first time, and how often.

    Parameters
    ----------
    run : Run

    Examples
    --------
    >>> from clepsydra.design.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.loop.default_scenario import default_scenario
    >>> from clepsydra.loop.loop import Loop
    >>> from clepsydra.process.reader import load_process
    >>> analysis = analyse(load_process("quadruple-tank"))
    >>> controller = design_simc(analysis.model, analysis.pairing)
    >>> happened_warnings(Loop(controller, analysis.model).run(default_scenario(analysis.model)))
    []
    """
    first: dict[str, tuple[float, str]] = {}
    times: dict[str, int] = {}
    for happening in happenings(run.process, run.values):
        first.setdefault(happening.event, (happening.time, happening.words))
        times[happening.event] = times.get(happening.event, 0) + happening.times
    words = []
    for event, (time, what) in first.items():
        for part, consequence in _FAULTS.items():
            if part in event:
                often = "" if times[event] == 1 else f", and {times[event]} times in all"
                words.append(f"{what}, at {time_text(time)}{often}: {consequence}.")
    return words
