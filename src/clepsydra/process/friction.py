"""Friction between the actuator of a valve and the stem that it moves: play, or stiction."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.process.hybrid import Event, switch_memory
from clepsydra.process.table_reader import TableReader
from clepsydra.program.step_law import Symbols

#: The actuator stands still, or has turned, when less of its way is left [share of the stroke].
_STANDSTILL = 1e-4


def _stem_memories(element: str) -> tuple[Signal, Signal]:
    """Return the place of a stem, and whether it is still as the actuator is at first.

    During the first step the stem stands where the actuator is, so that a plant at rest stays at
    rest wherever its operating point is, and so that a linear model has the gain of the valve.
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
        return _stem_memories(element)

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
            *_stem_memories(element),
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


def read_friction(table: TableReader) -> Backlash | Stiction | None:
    """Read what is between actuator and stem: play or stiction, but not both."""
    what = "a share of the stroke"
    if table.has("backlash"):
        expected = "no stiction beside backlash, since its band contains the play"
        table.refuse(("stiction", "slip_jump"), expected, "remove one of the two")
        remedy = "give the play, a small part of the stroke"
        return Backlash(table.quantity("backlash", "1", what, remedy, above=0.0, at_most=0.5))
    if not table.has("stiction"):
        remedy = 'remove it, or add the band as in stiction = "5 %"'
        table.refuse(("slip_jump",), "no jump without stiction", remedy)
        return None
    band = table.quantity(
        "stiction", "1", what, "give the way of a reversal until the stem moves",
        above=0.0, at_most=0.5,
    )  # fmt: skip
    jump = table.quantity(
        "slip_jump", "1", what, "give the jump of the stem, at most its stick band",
        above=0.0, at_most=band,
    )  # fmt: skip
    return Stiction(band, jump)
