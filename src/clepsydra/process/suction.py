"""Suction from a tank: a forced flow breaks off when its tank runs empty."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.process import told
from clepsydra.process.declared import part
from clepsydra.process.hybrid import Event, switch_memory, switching
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import Vessel, vessel_of
from clepsydra.program.step_law import Symbols

#: The key of a process file that `read_suction` knows.
SUCTION_KEY = "suction_level"
SUCTION_TOLD = {SUCTION_KEY: told.quantity("level of its tank at which its intake draws air", "m")}
#: Suction is lost where a tank holds this share of its capacity, if the file does not say.
_LOST = 0.01
#: It comes back when this share of the capacity has come in above that.
_REGAINED = 0.01

#: What the loss of suction means for what is no pump.
BREAKS_OFF = "nothing is left to draw, so that the flow breaks off; keep the level higher"


@dataclass(frozen=True)
class Suction:
    """What draws from a tank whatever its level is, until the level falls to the intake.

    No forced flow can be drawn from an empty tank: without this switch its volume would become
    negative. An intake stands above the floor, so that a concentration in what is left still has
    a meaning.

    Parameters
    ----------
    vessel : Vessel
        Of the tank.
    level : float or None
        Where suction ends [m]; None where the tank holds 1 % of its capacity.
    unit : str
        In which words give the level.
    harm : str
        What the loss means and how it is avoided.

    Examples
    --------
    >>> from clepsydra.process.vessels.prism import Prism
    >>> suction = Suction("tank", Prism(1.0, area=2.0), level=0.05)
    >>> suction.ends, round(suction.begins, 12)
    (0.05, 0.06)
    """

    tank: str
    vessel: Vessel
    level: float | None = None
    unit: str = "m"
    harm: str = field(default=BREAKS_OFF, compare=False)

    @property
    def ends(self) -> float:
        """The level at which suction is lost [m]."""
        return self._level(_LOST) if self.level is None else self.level

    @property
    def begins(self) -> float:
        """The level at which it comes back [m]."""
        held = float(self.vessel.volume(ca.SX(self.ends), self.vessel.values()))
        return self._level(held / self.vessel.capacity + _REGAINED)

    def memory(self, element: str) -> Signal:
        """Return the memory that is 1 while an element draws liquid, 0 after its tank ran empty."""
        return switch_memory(f"{element}.draws", 1.0, f"{element} draws liquid")

    def events(self, element: str, symbols: Symbols) -> tuple[Event, ...]:
        """Return the loss of suction near the floor of the tank and its return a little above."""
        level, draws = symbols[f"{self.tank}.level"], f"{element}.draws"
        dry = f"{element} runs dry: {self._words(below=True)}"
        again = f"{element} draws again: {self._words(below=False)}"
        return (
            switching(
                draws, symbols[draws] > 0.5, False, "runs_dry", dry, self.ends - level, self.harm
            ),
            switching(draws, symbols[draws] > 0.5, True, "draws_again", again, level - self.begins),
        )

    def _level(self, share: float) -> float:
        return float(self.vessel.level(ca.SX(share * self.vessel.capacity), self.vessel.values()))

    def _words(self, *, below: bool) -> str:
        if self.level is None:
            share = _LOST if below else _LOST + _REGAINED
            return f"{self.tank} holds {100 * share:.0f} % of its capacity"
        level = from_si(self.ends if below else self.begins, "m", self.unit)
        return f"{self.tank} {'below' if below else 'above'} {level:.4g} {self.unit}"


def read_suction(
    table: TableReader, source: str, *, forced: bool = True, harm: str = BREAKS_OFF
) -> Suction | None:
    """Read where an element no longer draws from its tank; None where it draws from no tank.

    An element draws by force that would go on drawing from an empty tank.
    """
    vessel = vessel_of(table, source) if source and forced else None
    if vessel is None:
        expected = "no such key, since nothing is drawn from a tank by force"
        table.refuse((SUCTION_KEY,), expected, "remove it")
        return None
    if not table.has(SUCTION_KEY):
        return Suction(source, vessel, harm=harm)
    remedy = (
        f"give the level of {source} at which its intake draws air; leave it out for that of 1 % "
        "of its capacity"
    )
    most = Suction(source, vessel)._level(1.0 - 2 * _REGAINED)
    level = table.quantity(SUCTION_KEY, "m", "a level", remedy, above=0.0, at_most=most)
    return Suction(source, vessel, level, table.display_units(SUCTION_KEY)[SUCTION_KEY], harm)


def drawing(harm: str = BREAKS_OFF) -> Any:
    """Return the field of an element that draws from its source by force."""
    return part(
        lambda table, key, known: read_suction(table, known["source"], harm=harm),
        SUCTION_TOLD,
        default=None,
    )


def drawn(element: str, flow: Any, symbols: Symbols, rest: Any = 0) -> ca.SX:
    """Return a flow while there is suction, and the rest of it after the tank ran empty."""
    return ca.if_else(symbols[f"{element}.draws"] > 0.5, flow, rest)
