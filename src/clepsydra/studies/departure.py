"""How far and for how long loads drive a level out of its band, which is no longer good enough."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.designs.request import in_shown_unit
from clepsydra.process.process import Process

#: A share of the measurement's range that no sensor shows, and rounding and integration may leave.
_NOTHING = 1e-4


@dataclass(frozen=True)
class Departure:
    """A level that left its band.

    Parameters
    ----------
    signal : Signal
        The measurement.
    time : float
        For how long in all [s].
    above, below : float
        How far at most [its unit].

    Examples
    --------
    >>> level = Signal("level", "1", "%", low=0.0, high=1.0)
    >>> Departure(level, 754.0, 0.034, 0.0).words
    'level is outside for 12.6 min, by at most 3.4 % above'
    """

    signal: Signal
    time: float
    above: float
    below: float

    @property
    def words(self) -> str:
        """For how long and how far, as a clause."""
        far = [
            f"{in_shown_unit(self.signal, depth)} {side}"
            for side, depth in (("above", self.above), ("below", self.below))
            if depth > _NOTHING * self.signal.span
        ]
        name = self.signal.name
        return f"{name} is outside for {time_text(self.time)}, by at most {' and '.join(far)}"


def departures(process: Process, scores: Mapping[str, float]) -> tuple[Departure, ...]:
    """Return the levels that a run with these scores took out of their bands."""
    found = []
    for name in process.bands:
        signal = process.signal(name)
        time, above, below = (
            scores.get(f"{key}[{name}]", 0.0)
            for key in ("time_outside_band", "above_band", "below_band")
        )
        if max(above, below) > _NOTHING * signal.span:
            found.append(Departure(signal, time, above, below))
    return tuple(found)
