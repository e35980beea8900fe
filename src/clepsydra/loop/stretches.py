"""The stretches of a scenario between its events, and of each its end, where it should be quiet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from clepsydra.loop.scenario import Scenario
from clepsydra.scores.load_response import LAST_SHARE
from clepsydra.scores.segment import Segment


@dataclass(frozen=True)
class Stretch:
    """The samples that end within a segment, or between segments.

    Parameters
    ----------
    segment : Segment or None
        None where nothing happens, or several things at once.
    parts : tuple of int
        The first sample of each part, and one past the last. A segment with a step has three: its
        first half, what follows, and its last tenth, over which an offset is averaged.
    """

    segment: Segment | None
    parts: tuple[int, ...]

    @property
    def spans(self) -> Iterator[tuple[int, int]]:
        """First sample of each part, and one past its last."""
        return pairwise(self.parts)


def stretches_of(scenario: Scenario) -> tuple[Stretch, ...]:
    """Return the stretches of a scenario, which hold each of its samples once.

    A sample belongs to where the time before it does: at the stop of a segment the output still is
    what that segment made of it.

    Examples
    --------
    >>> import numpy as np
    >>> nothing, steps = np.zeros((100, 0)), (Segment("setpoint", "y", 10.0, 60.0, 1.0),)
    >>> for stretch in stretches_of(Scenario(1.0, nothing, nothing, nothing, steps, 1)):
    ...     print(stretch.parts)
    (0, 11)
    (11, 36, 56, 61)
    (61, 100)
    """
    found, period, done = [], scenario.sampling_period, 0
    for segment in scenario.segments:
        first = scenario.sample_of(segment)
        last = min(round(segment.stop / period), scenario.samples - 1)
        if first + 1 > done:
            found.append(Stretch(None, (done, first + 1)))
        length = last - first
        cuts = {first + 1, last + 1}
        if segment.kind != "noise" and length >= _SHORTEST:
            settled = scenario.settled_sample_of(segment)
            middle = settled + (last - settled) // 2
            tail = last - max(1, round(LAST_SHARE * length))
            cuts |= {min(middle, tail) + 1, tail + 1}
        found.append(Stretch(segment, tuple(sorted(cuts))))
        done = last + 1
    if done < scenario.samples:
        found.append(Stretch(None, (done, scenario.samples)))
    return tuple(found)


#: Samples of a segment that is cut in parts.
_SHORTEST = 20
