"""Suction from a tank: a forced flow breaks off when its tank runs empty."""

from __future__ import annotations

from typing import Any

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Event, switch_memory
from clepsydra.process.vessels.vessel import Vessel
from clepsydra.program.step_law import Symbols

#: Suction is lost where a tank holds this share of its capacity, and comes back at the other.
_LOST, _REGAINED = 0.01, 0.02


def suction_memory(element: str) -> Signal:
    """Return the memory that is 1 while an element draws liquid and 0 after its tank ran empty.

    Examples
    --------
    >>> suction_memory("pump_1").name
    'pump_1.draws'
    """
    return switch_memory(f"{element}.draws", 1.0, f"{element} draws liquid")


def suction_events(element: str, tank: str, vessel: Vessel, symbols: Symbols) -> tuple[Event, ...]:
    """Return the loss of suction near the floor of a tank and its return a little above.

    No forced flow can be drawn from an empty tank: without this switch its volume would become
    negative. It is lost a hundredth above empty, as an intake stands above the floor, so that a
    concentration in what is left still has a meaning.

    Parameters
    ----------
    element, tank : str
    vessel : Vessel
        Of the tank.
    symbols : mapping

    Examples
    --------
    >>> from clepsydra.process.vessels.prism import Prism
    >>> symbols = {"tank.level": ca.SX(0.5), "pump.draws": ca.SX(1)}
    >>> events = suction_events("pump", "tank", Prism(1.0, area=2.0), symbols)
    >>> [float(event.guard) for event in events]
    [-0.49, -1.0]
    """
    level, draws = symbols[f"{tank}.level"], symbols[f"{element}.draws"]
    name = f"{element}.draws"
    lost, regained = (
        float(vessel.level(ca.SX(share * vessel.capacity), vessel.values()))
        for share in (_LOST, _REGAINED)
    )
    return (
        Event(
            f"{element}.runs_dry",
            f"{element} runs dry: {tank} holds {_LOST:.0%} of its capacity",
            ca.if_else(draws > 0.5, lost - level, -1.0),
            {name: 0.0},
        ),
        Event(
            f"{element}.draws_again",
            f"{element} draws again: {tank} holds {_REGAINED:.0%} of its capacity",
            ca.if_else(draws > 0.5, -1.0, level - regained),
            {name: 1.0},
        ),
    )


def drawn(element: str, flow: Any, symbols: Symbols, rest: Any = 0) -> ca.SX:
    """Return a flow while there is suction, and the rest of it after the tank ran empty.

    Examples
    --------
    >>> drawn("pump", ca.SX(2.0), {"pump.draws": ca.SX(0)})
    SX(0)
    """
    return ca.if_else(symbols[f"{element}.draws"] > 0.5, flow, rest)
