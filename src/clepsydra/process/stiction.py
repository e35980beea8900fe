"""Stiction: a stem that sticks, breaks away with a jump, and sticks again."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.backlash import stem_memories
from clepsydra.process.hybrid import Event
from clepsydra.program.step_law import Symbols

#: The actuator stands still, or has turned, when less of its way is left [share of the stroke].
_STANDSTILL = 1e-4


@dataclass(frozen=True)
class Stiction:
    """Stiction with two parameters: stick band S and slip jump J.

    The actuator pulls at the stem with the difference of their places. Stuck, the stem breaks
    away when the difference reaches the static friction (S + J)/2, jumps by J, and then follows
    at the distance (S - J)/2 of the kinetic friction, until the actuator stands still or turns.
    A reversal therefore needs a way of S, going on the same way one of J. The parameters and the
    loop over one cycle are those of M. A. A. S. Choudhury, N. F. Thornhill, S. L. Shah,
    Modelling valve stiction, Control Engineering Practice 13(5), 2005, doi
    10.1016/j.conengprac.2004.05.005; the balance of static and kinetic friction is that of
    Q. P. He, J. Wang, M. Pottmann, S. J. Qin, A curve fitting method for detecting valve stiction
    in oscillating control loops, Industrial & Engineering Chemistry Research 46(13), 2007, doi
    10.1021/ie061219a, which it equals where the actuator follows its signal at once.

    Parameters
    ----------
    band : float
        S, as a share of the stroke.
    jump : float
        J, as a share of the stroke, above 0 and at most S.

    Examples
    --------
    A stem at 50 % with S = 6 % and J = 2 % is pulled at by 3 % and holds until 4 %:

    >>> symbols = {"valve.stem": ca.SX(0.5), "valve.begins": ca.SX(0), "valve.moves": ca.SX(0),
    ...            "valve.stiction": ca.SX(0.06), "valve.slip_jump": ca.SX(0.02)}
    >>> events = Stiction(0.06, 0.02).events("valve", ca.SX(0.53), ca.SX(0.6), symbols)
    >>> [(event.name, round(float(event.guard), 3)) for event in events[:2]]
    [('valve.breaks_away_up', -0.01), ('valve.breaks_away_down', -0.07)]
    """

    band: float
    jump: float

    def parameters(self) -> tuple[tuple[str, float, str], ...]:
        """Return key, value and description of its numbers, shares of the stroke."""
        return (
            ("stiction", self.band, "stick band of"),
            ("slip_jump", self.jump, "slip jump of"),
        )

    def memories(self, element: str) -> tuple[Signal, ...]:
        """Return the place of the stuck stem, and which way it moves: -1, 0 or 1."""
        return (
            *stem_memories(element),
            Signal(
                f"{element}.moves", low=-1.0, high=1.0,
                description=f"direction of the stem of {element}",
            ),
        )  # fmt: skip

    def stem(self, element: str, position: ca.SX, symbols: Symbols) -> ca.SX:
        """Return where the stem is while the actuator is at a position."""
        moves = symbols[f"{element}.moves"]
        _, kinetic = self._frictions(element, symbols)
        follows = position - moves * kinetic
        held = ca.if_else(ca.fabs(moves) > 0.5, follows, symbols[f"{element}.stem"])
        return ca.if_else(symbols[f"{element}.begins"] > 0.5, position, held)

    def events(
        self, element: str, position: ca.SX, asked: ca.SX, symbols: Symbols
    ) -> tuple[Event, ...]:
        """Return where the stem breaks away, up and down, and where it sticks again."""
        moves, stem = symbols[f"{element}.moves"], symbols[f"{element}.stem"]
        static, kinetic = self._frictions(element, symbols)
        held = ca.logic_and(symbols[f"{element}.begins"] <= 0.5, ca.fabs(moves) <= 0.5)
        return (
            *(
                Event(
                    f"{element}.breaks_away_{side}",
                    f"the stem of {element} breaks away {side}",
                    ca.if_else(held, direction * (position - stem) - static, -1),
                    {f"{element}.moves": direction},
                )
                for side, direction in (("up", 1.0), ("down", -1.0))
            ),
            Event(
                f"{element}.sticks",
                f"the stem of {element} sticks",
                ca.if_else(ca.fabs(moves) > 0.5, _STANDSTILL - moves * (asked - position), -1),
                {
                    f"{element}.moves": 0.0,
                    f"{element}.stem": position - moves * kinetic,
                },
            ),
        )

    @staticmethod
    def _frictions(element: str, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
        """Return static and kinetic friction, as shares of the stroke."""
        band, jump = symbols[f"{element}.stiction"], symbols[f"{element}.slip_jump"]
        return (band + jump) / 2, (band - jump) / 2
