"""What a closed vessel does when it is full: nothing more flows in, or the run ends."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Event, switch_memory, switching
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import Vessel
from clepsydra.program.step_law import Symbols

#: The key of a process file that `read_lid` knows, and its values; the first is an open tank's.
LID_KEY = "when_full"
LID_CHOICES = RISES, STOPS, ENDS = "level rises", "inflow stops", "run ends"
#: Inflow comes back when this share of the capacity has left.
_ROOM = 0.01


@dataclass(frozen=True)
class Lid:
    """A closed vessel, whose level is never above its top.

    Liquid is not compressed and nothing is known of the pressures: what a full vessel does is a
    choice. Either its inflows stop, and begin again when a hundredth of its capacity is free, or
    the run ends: everything stands still from then on.

    Parameters
    ----------
    vessel : Vessel
        Of the tank.
    ends : bool
        The run ends; else inflow stops.

    Examples
    --------
    >>> from clepsydra.process.vessels.prism import Prism
    >>> lid = Lid(Prism(2.0, area=1.0), ends=False)
    >>> symbols = {"drum.full": ca.SX(0), "drum.volume": ca.SX(1.5), "drum.area": ca.SX(1)}
    >>> [float(event.guard) for event in lid.events("drum", symbols)]
    [-0.5, -1.0]
    """

    vessel: Vessel
    ends: bool

    def memory(self, element: str) -> Signal:
        """Return the memory that is 1 from when it is full."""
        return switch_memory(f"{element}.full", 0.0, f"{element} is full")

    def is_full(self, element: str, symbols: Symbols) -> ca.SX:
        """Return the truth that nothing can flow in, or that the run has ended."""
        return symbols[f"{element}.full"] > 0.5

    def events(self, element: str, symbols: Symbols) -> tuple[Event, ...]:
        """Return that it is full, and that it takes in again."""
        volume = symbols[f"{element}.volume"]
        capacity = self.vessel.full(self.vessel.sizes(element, symbols))
        # The guards are lengths, as those of levels are.
        length = self.vessel.height / self.vessel.capacity
        full, on, words = f"{element}.full", self.is_full(element, symbols), f"{element} is full"
        excess = (volume - capacity) * length
        if self.ends:
            words += ": the run ends"
            harm = "what a closed vessel does then is not simulated; keep its level lower"
            return (switching(full, on, True, "fills", words, excess, harm, ends=True),)
        harm = (
            "nothing more flows in, so that pumps work against a closed vessel; keep its level "
            "lower"
        )
        again = f"{element} takes in again: it holds {100 * (1 - _ROOM):.0f} % of its capacity"
        room = ((1 - _ROOM) * capacity - volume) * length
        return (
            switching(full, on, True, "fills", words, excess, harm),
            switching(full, on, False, "takes_in_again", again, room),
        )


def read_lid(table: TableReader, vessel: Vessel, *, spills: bool) -> Lid | None:
    """Read what a tank does when it is full; None where its level rises above the rim.

    Left out, the inflow of a vessel stops whose rim is a point or a line, and the level of any
    other rises. A weir takes the place of a lid.
    """
    if spills:
        expected = "no such key beside a weir, over which a full tank spills"
        table.refuse((LID_KEY,), expected, "remove one of the two")
        return None
    choices = (STOPS, ENDS) if vessel.closed else LID_CHOICES
    choice = table.choice(LID_KEY, choices, choices[0])
    return None if choice == RISES else Lid(vessel, ends=choice == ENDS)
