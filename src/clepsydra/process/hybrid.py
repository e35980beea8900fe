"""Hybrid behaviour of elements: events that switch a memory, and delays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal


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

    Examples
    --------
    >>> Delay("channel.delayed_flow", "m^3/s", 300.0, "liquid").time
    300.0
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

    Examples
    --------
    >>> level, on = ca.SX.sym("level"), ca.SX.sym("on")
    >>> Event("pump.stops", "pump stops", ca.if_else(on, 0.2 - level, -1), {"on": 0}).name
    'pump.stops'
    """

    name: str
    words: str
    guard: ca.SX
    resets: Mapping[str, ca.SX | float]
    harm: str = ""
    ends: bool = False


def switch_memory(name: str, initial: float, description: str) -> Signal:
    """Return a memory that is 0 or 1.

    Examples
    --------
    >>> switch_memory("pump_1.tripped", 0.0, "pump_1 has tripped").high
    1.0
    """
    return Signal(name, kind="boolean", low=0.0, high=1.0, initial=initial, description=description)
