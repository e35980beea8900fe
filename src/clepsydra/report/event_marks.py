"""Events as lists and pictures show them: what happens again and again is one line and one mark."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from clepsydra.base.words import time_text
from clepsydra.loop.events import Occurrence

#: An event that happens more often than this is one mark; else each time is one.
_APART = 5


@dataclass(frozen=True)
class EventMark:
    """An event, or all of its times together.

    Parameters
    ----------
    time : float
        The first time [s].
    words : str
    times : int
        How often in all.
    last : float
        The last time [s].

    Examples
    --------
    >>> EventMark(12.0, "pump_1 trips: tank_3 above 27.5 cm", 289, 8000.0).sentence
    'pump_1 trips: tank_3 above 27.5 cm (289 times, the last at 133.3 min)'
    """

    time: float
    words: str
    times: int
    last: float

    @property
    def sentence(self) -> str:
        """What happens, and how often where that is more than once."""
        if self.times == 1:
            return self.words
        last = "" if self.last == self.time else f", the last at {time_text(self.last, 4)}"
        return f"{self.words} ({self.times} times{last})"

    def label(self, number: int) -> str:
        """Return its number, with the count where it stands for several."""
        return str(number) if self.times == 1 else f"{number} (×{self.times})"


def event_marks(events: Sequence[Occurrence]) -> tuple[EventMark, ...]:
    """Return the marks of what happened, in order of their first time.

    Examples
    --------
    >>> often = [Occurrence(float(t), "p.trips", "p trips", 1) for t in range(10, 299)]
    >>> (mark,) = event_marks(often)
    >>> mark.time, mark.times, mark.last
    (10.0, 289, 298.0)
    >>> len(event_marks(often[:3]))
    3
    """
    by_event: defaultdict[str, list[Occurrence]] = defaultdict(list)
    for event in events:
        by_event[event.event].append(event)
    marks = []
    for all_of_it in by_event.values():
        groups = [all_of_it] if len(all_of_it) > _APART else [[each] for each in all_of_it]
        marks += [
            EventMark(
                group[0].time, group[0].words, sum(each.times for each in group), group[-1].time
            )
            for group in groups
        ]
    return tuple(sorted(marks, key=lambda mark: mark.time))
