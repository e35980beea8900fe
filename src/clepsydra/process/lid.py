"""What a closed vessel does when it is full: nothing more flows in, or the run ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Event, switch_memory
from clepsydra.process.vessels.vessel import Vessel
from clepsydra.program.step_law import Symbols

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader

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
    tank : str
    vessel : Vessel
        Of the tank.
    ends : bool
        The run ends; else inflow stops.

    Examples
    --------
    >>> from clepsydra.process.vessels.prism import Prism
    >>> lid = Lid("drum", Prism(2.0, area=1.0), ends=False)
    >>> symbols = {"drum.full": ca.SX(0)}
    >>> [float(event.guard) for event in lid.events(symbols, ca.SX(1.5), ca.SX(2.0))]
    [-0.5, -1.0]
    """

    tank: str
    vessel: Vessel
    ends: bool

    @property
    def _full(self) -> str:
        return f"{self.tank}.full"

    def memory(self) -> Signal:
        """Return the memory that is 1 from when it is full."""
        return switch_memory(self._full, 0.0, f"{self.tank} is full")

    def is_full(self, symbols: Symbols) -> ca.SX:
        """Return the truth that nothing can flow in, or that the run has ended."""
        return symbols[self._full] > 0.5

    def events(self, symbols: Symbols, volume: ca.SX, capacity: ca.SX) -> tuple[Event, ...]:
        """Return that it is full, and that it takes in again.

        Parameters
        ----------
        symbols : mapping
        volume, capacity : casadi.SX
            What it holds and what it can hold [m³].
        """
        # The guards are lengths, as those of levels are.
        length = self.vessel.height / self.vessel.capacity
        full = self.is_full(symbols)
        fills = Event(
            f"{self.tank}.fills",
            f"{self.tank} is full" + (": the run ends" if self.ends else ""),
            ca.if_else(full, -1.0, (volume - capacity) * length),
            {self._full: 1.0},
            "what a closed vessel does then is not simulated; keep its level lower"
            if self.ends
            else "nothing more flows in, so that pumps work against a closed vessel; keep its "
            "level lower",
            ends=self.ends,
        )
        if self.ends:
            return (fills,)
        takes = Event(
            f"{self.tank}.takes_in_again",
            f"{self.tank} takes in again: it holds {100 * (1 - _ROOM):.0f} % of its capacity",
            ca.if_else(full, ((1 - _ROOM) * capacity - volume) * length, -1.0),
            {self._full: 0.0},
        )
        return fills, takes


def read_lid(table: TableReader, tank: str, vessel: Vessel, *, spills: bool) -> Lid | None:
    """Read what a tank does when it is full; None where its level rises above the rim.

    Left out, the inflow of a vessel stops whose rim is a point or a line, and the level of any
    other rises. A weir takes the place of a lid.

    Parameters
    ----------
    table : TableReader
    tank : str
    vessel : Vessel
    spills : bool
        It has a weir.

    Raises
    ------
    InputError
        A vessel that is closed is to rise, or one with a weir not to.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> from clepsydra.process.vessels.sphere_segment import SphereSegment
    >>> table = TableReader(parse(b"[tanks.ball]", "plant.toml"), ("tanks", "ball"), None)
    >>> read_lid(table, "ball", SphereSegment(diameter=2.0, height=2.0), spills=False).ends
    False
    """
    if spills:
        if table.has(LID_KEY):
            raise table.wrong(
                LID_KEY,
                "no such key beside a weir, over which a full tank spills",
                "remove one of the two",
            )
        return None
    choices = (STOPS, ENDS) if vessel.closed else LID_CHOICES
    choice = table.choice(LID_KEY, choices, choices[0])
    return None if choice == RISES else Lid(tank, vessel, ends=choice == ENDS)
