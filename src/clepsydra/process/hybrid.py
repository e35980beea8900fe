"""Hybrid behaviour of elements: events that switch a memory, and delays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.program.step_law import Symbols


@dataclass(frozen=True)
class Delay:
    """A quantity that comes back after a fixed time: z(t) = w(t - τ).

    Parameters
    ----------
    name : str
        "channel.flow": element and quantity.
    unit : str
        SI unit of the quantity.
    time : float
        τ [s].
    conserves : str
        "liquid" or the component whose flow it is; empty for a quantity of another kind.
    """

    name: str
    unit: str
    time: float
    conserves: str = ""


@dataclass(frozen=True)
class Event:
    """A switch: when its guard becomes zero or positive, memories take new values.

    The moment is located inside the integration step. A reset must make the guard negative
    again, so a switch has hysteresis.

    Parameters
    ----------
    name : str
        "pump_1.trips": element and what it does, an identifier each.
    words : str
        For the list of events: "pump_1 trips: tank_3 above 27.5 cm".
    guard : casadi.SX
        Negative while nothing happens; continuous where it changes sign.
    resets : mapping
        Memory name to its new value.
    harm : str
        What it does to the plant and how it is avoided, where no plant is meant to see it: a
        controller in whose run it happens is unsafe. Empty for what is part of normal operation.
    ends : bool
        The run ends there: from then on everything stands still, see `Element.ended`.
    """

    name: str
    words: str
    guard: ca.SX
    resets: Mapping[str, ca.SX | float]
    harm: str = ""
    ends: bool = False


class Switch(Protocol):
    """What remembers one of two positions for its element, and changes it at events."""

    def memory(self, element: str) -> Signal:
        """Return the memory of its position."""

    def events(self, element: str, symbols: Symbols) -> tuple[Event, ...]:
        """Return when it changes its position."""


def switch_memory(name: str, initial: float, description: str) -> Signal:
    """Return a memory that is 0 or 1."""
    return Signal(name, kind="boolean", low=0.0, high=1.0, initial=initial, description=description)


def switching(
    memory: str,
    on: ca.SX,
    to: bool,
    what: str,
    words: str,
    excess: ca.SX,
    harm: str = "",
    *,
    ends: bool = False,
) -> Event:
    """Return the event that sets a memory to 1 or to 0, in the other position, beyond a limit.

    `on` is the truth that the memory is 1, the same for all events of a switch.

    Examples
    --------
    >>> event = switching("pump.runs", ca.SX(1), False, "stops", "pump stops", ca.SX(-0.2))
    >>> event.name, float(event.guard), event.resets
    ('pump.stops', -0.2, {'pump.runs': 0.0})
    """
    guard = ca.if_else(on, -1, excess) if to else ca.if_else(on, excess, -1)
    name = f"{memory.rpartition('.')[0]}.{what}"
    return Event(name, words, guard, {memory: float(to)}, harm, ends)
