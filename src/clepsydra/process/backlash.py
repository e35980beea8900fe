"""Backlash: play between an actuator and the stem that it moves."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Event, switch_memory
from clepsydra.program.step_law import Symbols


def stem_memories(element: str) -> tuple[Signal, Signal]:
    """Return the place of a stem, and whether it is still as the actuator is at first.

    During the first step the stem stands where the actuator is, so that a plant at rest stays at
    rest wherever its operating point is, and so that a linear model has the gain of the valve.

    Examples
    --------
    >>> [signal.name for signal in stem_memories("valve_1")]
    ['valve_1.stem', 'valve_1.begins']
    """
    return (
        Signal(f"{element}.stem", low=0.0, high=1.0, description=f"stem of {element}"),
        switch_memory(
            f"{element}.begins", 1.0, f"stem of {element} stands where its actuator does"
        ),
    )


@dataclass(frozen=True)
class Backlash:
    """Play of a width b: the actuator moves the stem only after it has crossed it.

    The play operator, stem = min(max(stem, s - b/2), s + b/2), M. Brokate, J. Sprekels, Hysteresis
    and Phase Transitions, 1996, chapter 2, doi 10.1007/978-1-4612-4048-8. It is exact while the
    actuator moves one way; where the stem stands is remembered at the end of every integration
    step.

    Parameters
    ----------
    width : float
        b, as a share of the stroke.

    Examples
    --------
    An actuator that comes back by 3 % takes the stem along for the last 1 %:

    >>> symbols = {"valve.stem": ca.SX(0.49), "valve.begins": ca.SX(0)}
    >>> symbols["valve.backlash"] = ca.SX(0.02)
    >>> float(Backlash(0.02).stem("valve", ca.SX(0.47), symbols))
    0.48
    """

    width: float

    def parameters(self) -> tuple[tuple[str, float, str], ...]:
        """Return key, value and description of its numbers, shares of the stroke."""
        return (("backlash", self.width, "play of"),)

    def memories(self, element: str) -> tuple[Signal, ...]:
        """Return the place of the stem."""
        return stem_memories(element)

    def stem(self, element: str, position: ca.SX, symbols: Symbols) -> ca.SX:
        """Return where the stem is while the actuator is at a position."""
        half = symbols[f"{element}.backlash"] / 2
        kept = ca.fmin(ca.fmax(symbols[f"{element}.stem"], position - half), position + half)
        return ca.if_else(symbols[f"{element}.begins"] > 0.5, position, kept)

    def events(
        self, element: str, position: ca.SX, asked: ca.SX, symbols: Symbols
    ) -> tuple[Event, ...]:
        """Return nothing: play needs no moment to be found."""
        return ()
