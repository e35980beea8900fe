"""Harm to the plant in a run: what overflows, runs dry, trips or diverges, when and how often."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.loop.events import events_of
from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.loop.run import Run
from clepsydra.studies.warnings.words import shown

#: What a state does, and what that means.
_EMPTY = ("runs empty", "what is drawn from it breaks off")
_DIVERGED = (
    "is not a number",
    "the loop has diverged, and nothing after that counts; lower the gains",
)
_SPILT = "it spills; make the step smaller or the gain larger"
_HIGHER = (
    "the model spills nothing, since it has no weir, and the rest of the run holds for a higher "
    "tank only"
)


@dataclass(frozen=True)
class Harm:
    """What no plant is meant to see; a controller in whose run it happens is unsafe.

    Parameters
    ----------
    time : float
        The first time [s].
    words : str
        What happens.
    consequence : str
        What it means and what to do.
    times : int
        How often.
    remark : str
        Beside the time, such as the range that is left.

    Examples
    --------
    >>> harm = Harm(12.0, "pump_1 runs dry: tank_1 is empty", "keep its level higher", times=3)
    >>> harm.brief
    'pump_1 runs dry at 12 s, and 3 times in all'
    >>> harm.sentence
    'pump_1 runs dry: tank_1 is empty, at 12 s, and 3 times in all: keep its level higher.'
    """

    time: float
    words: str
    consequence: str
    times: int = 1
    remark: str = ""

    @property
    def brief(self) -> str:
        """What happens, when first, and how often, without the reason."""
        return self._dated(self.words.partition(":")[0])

    @property
    def sentence(self) -> str:
        """What happens and what it means."""
        return f"{self._dated(self.words)}: {self.consequence}."

    def _dated(self, words: str) -> str:
        comma = "," if ":" in words else ""
        remark = f" ({self.remark})" if self.remark else ""
        often = "" if self.times == 1 else f", and {self.times} times in all"
        return f"{words}{comma} at {time_text(self.time)}{remark}{often}"


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
            found += [replace(each, times=1) for each in _seen(run, x, empty, *_EMPTY)]
    return found


def _of_events(run: Run) -> list[Harm]:
    happened = events_of(run.process, run.values)
    found = []
    for event in run.process.motion.events:
        times = [each for each in happened if each.event == event.name]
        if event.harm and times:
            count = sum(each.times for each in times)
            found.append(Harm(times[0].time, event.words, event.harm, count))
    return found


def _of_states(run: Run) -> list[Harm]:
    found = []
    spilling = {x.name for e in run.process.elements if e.spilt for x in e.states()}
    for x in run.process.state:
        values = run.values[x.name]
        found += _seen(run, x, ~np.isfinite(values), *_DIVERGED)
        if x.name in run.process.levels:
            lost = _SPILT if x.name in spilling else _HIGHER
            found += _seen(run, x, values > x.high, "rises above its rim", lost)
            found += _seen(run, x, values < x.low, *_EMPTY)
    return found


def _seen(run: Run, x: Signal, where: np.ndarray, what: str, consequence: str) -> list[Harm]:
    """Return what a state shows at some samples, if at any."""
    if not np.any(where):
        return []
    first = float(run.time[int(np.argmax(where))])
    times = int(np.sum(np.diff(where.astype(int), prepend=0) > 0))
    remark = f"range {shown(x.low, x)} to {shown(x.high, x)}"
    return [Harm(first, f"{x.name} {what}", consequence, times, remark)]
