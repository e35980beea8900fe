"""Harm to the plant in a run: what overflows, runs dry, trips or diverges, when and how often."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.linear.signal_words import shown
from clepsydra.loop.events import events_of
from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.loop.run import Run

#: What a state does, what that means, and what to do.
_EMPTY = ("runs empty", "what is drawn from it breaks off")
_DIVERGED = (
    "is not a number",
    "the loop has diverged, and nothing after that counts",
    "lower the gains",
)
_SPILT = ("it spills", "make the step smaller or the gain larger")
_HIGHER = (
    "the model spills nothing, since it has no weir, and the rest of the run holds for a higher "
    "tank only",
)


class Harm(NamedTuple):
    """What no plant is meant to see; a controller in whose run it happens is unsafe.

    Parameters
    ----------
    time : float
        The first time [s].
    brief : str
        What happens, when first, and how often, without the reason.
    warning : Remark
        What happens and what it means.

    Examples
    --------
    >>> harm = Harm.dated(12.0, "pump_1 runs dry: tank_1 is empty", "keep it fuller", times=3)
    >>> harm.brief
    'pump_1 runs dry at 12 s, and 3 times in all'
    >>> print(harm.warning)
    pump_1 runs dry: tank_1 is empty, at 12 s, and 3 times in all: keep it fuller.
    """

    time: float
    brief: str
    warning: Remark

    @classmethod
    def dated(
        cls, time: float, words: str, *meaning: str, times: int = 1, beside: str = ""
    ) -> Harm:
        """Return what happens with its first time, how often, and what stands beside the time."""
        what, colon, _ = words.partition(":")
        often = "" if times == 1 else f", and {times} times in all"
        when = f" at {time_text(time)}{beside}{often}"
        return cls(time, what + when, Remark(words + ("," if colon else "") + when, *meaning))


def harms(run: Run) -> tuple[Harm, ...]:
    """Return what harms the plant in a run, in the order of the first time.

    An element says of each of its events whether it does harm (`Event.harm`). A level beyond floor
    or rim and a state that stops being a number are seen at the samples.
    """
    found = [*_of_states(run), *_of_events(run)]
    return tuple(sorted(found, key=lambda harm: harm.time))


def emptied(run: Run) -> list[Harm]:
    """Return which levels came down to the floor, and when; one below it is a harm of its own.

    By itself it harms nothing where nothing is pumped.
    """
    found = []
    for x in run.process.state:
        values = run.values[x.name]
        if x.name in run.process.levels and not np.any(values < x.low):
            empty = values <= x.low + EMPTY_SHARE * (x.high - x.low)
            empty &= np.cumsum(~empty) > 0  # what begins empty has not come down
            found += _seen(run, x, empty, *_EMPTY, often=False)
    return found


def _of_events(run: Run) -> list[Harm]:
    happened = events_of(run.process, run.values)
    found = []
    for event in run.process.motion.events:
        times = [each for each in happened if each.event == event.name]
        if event.harm and times:
            count = sum(each.times for each in times)
            found.append(Harm.dated(times[0].time, event.words, event.harm, times=count))
    return found


def _of_states(run: Run) -> list[Harm]:
    found = []
    spilling = {x.name for e in run.process.elements if e.spilt for x in e.states()}
    for x in run.process.state:
        values = run.values[x.name]
        found += _seen(run, x, ~np.isfinite(values), *_DIVERGED)
        if x.name in run.process.levels:
            lost = _SPILT if x.name in spilling else _HIGHER
            found += _seen(run, x, values > x.high, "rises above its rim", *lost)
            found += _seen(run, x, values < x.low, *_EMPTY)
    return found


def _seen(
    run: Run, x: Signal, where: np.ndarray, what: str, *meaning: str, often: bool = True
) -> list[Harm]:
    """Return what a state shows at some samples, if at any, and how often if that is wanted."""
    if not np.any(where):
        return []
    first = float(run.time[int(np.argmax(where))])
    times = int(np.sum(np.diff(where.astype(int), prepend=0) > 0)) if often else 1
    beside = f" (range {shown(x, x.low)} to {shown(x, x.high)})"
    return [Harm.dated(first, f"{x.name} {what}", *meaning, times=times, beside=beside)]
