"""Harm to the plant in a run: what overflows, runs dry, trips or diverges, when and how often."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.loop.happenings import happenings
from clepsydra.loop.run import Run
from clepsydra.study.warnings.words import shown

#: What it means that a tank is empty.
BREAKS_OFF = "what is drawn from it breaks off"


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
    >>> harms(Loop(controller, analysis.model).run(default_scenario(analysis.model)))
    ()
    """
    found = [*_of_levels(run), *_of_events(run)]
    return tuple(sorted(found, key=lambda harm: harm.time))


def _of_events(run: Run) -> list[Harm]:
    happened = happenings(run.process, run.values)
    found = []
    for event in run.process.motion.events:
        times = [each for each in happened if each.event == event.name]
        if event.harm and times:
            count = sum(each.times for each in times)
            found.append(Harm(times[0].time, event.words, event.harm, count))
    return found


def _of_levels(run: Run) -> list[Harm]:
    found = []
    for x in run.process.state:
        values = run.values[x.name]
        cases = [
            (
                ~np.isfinite(values),
                "is not a number",
                "the loop has diverged, and nothing after that counts; lower the gains",
            )
        ]
        if x.name in run.process.levels:
            cases.append((values > x.high, "rises above its rim", _lost_above(run, x)))
            cases.append((values < x.low, "runs empty", BREAKS_OFF))
        for where, what, consequence in cases:
            if np.any(where):
                first = float(run.time[int(np.argmax(where))])
                times = int(np.sum(np.diff(where.astype(int), prepend=0) > 0))
                remark = f"range {shown(x.low, x)} to {shown(x.high, x)}"
                found.append(Harm(first, f"{x.name} {what}", consequence, times, remark))
    return found


def _lost_above(run: Run, level: Signal) -> str:
    spilt = f"{level.name.removesuffix('level')}spilt"
    if any(total.name == spilt for total in run.process.motion.totals):
        return "it spills; make the step smaller or the gain larger"
    return (
        "the model spills nothing, since it has no weir, and the rest of the run "
        "holds for a higher tank only"
    )
