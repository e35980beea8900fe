"""A signal: one named scalar with its unit and its range."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

Kind = Literal["real", "integer", "boolean"]


@dataclass(frozen=True)
class Signal:
    """A named scalar quantity: an input, a parameter, a state or an output.

    Parameters
    ----------
    name : str
        Its path: whole words joined by underscores, a dot between what owns it and what it is
        of that ("tank_1.level").
    unit : str
        SI unit of every number held for this signal; "1" for none.
    display_unit : str
        The unit that the reader sees; the SI unit where empty.
    low, high : float
        The range [unit]; 0 % and 100 % of a signal that is not itself in percent.
    initial : float
        Initial value of a state, nominal value of an input, value of a parameter [unit].
    kind : {"real", "integer", "boolean"}
        The type that a printed program declares.
    description : str
        One phrase for comments, axes and tables.
    digits : int
        Of a parameter: the significant digits that a design gives to it.
    matrix : str
        Of a parameter: the matrix that it is a number of, if of one.
    record : str
        Of an output: the type of the structure that it is a member of, if of one; its owner is the
        structure, its part the member.
    optional : bool
        Of an output of a block: it is printed only where something reads it.
    below : str
        Of a parameter: the part of the same owner that it has to be below, if there is one.
    bolder : float
        Of a parameter: the power of a factor by which it grows where its law is made bolder by that
        factor; 0 where it stays.

    Examples
    --------
    >>> level = Signal("tank_1.level", "m", display_unit="cm", low=0.0, high=0.2)
    >>> level.to_percent(0.124)
    62.0
    """

    name: str
    unit: str = "1"
    display_unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    initial: float = 0.0
    kind: Kind = "real"
    description: str = ""
    digits: int = field(default=6, repr=False, compare=False)
    matrix: str = field(default="", repr=False, compare=False)
    record: str = field(default="", repr=False)
    optional: bool = field(default=False, repr=False, compare=False)
    below: str = field(default="", repr=False, compare=False)
    bolder: float = field(default=0.0, repr=False, compare=False)

    @property
    def span(self) -> float:
        """The width of the range, high - low [unit]; infinite where a limit is open.

        >>> Signal("pump_1", "V", low=-2.0, high=10.0).span, Signal("tank_1.area", low=0.0).span
        (12.0, inf)
        """
        return self.high - self.low

    @property
    def percent_scale(self) -> tuple[float, float]:
        """The values that 0 % and 100 % of the signal stand for [unit].

        Every percent of a signal is of this scale: of values, rates, gains, axes and tables. A
        signal that is stated in percent says itself what they are, and its range may end at
        another number; of any other signal they are the ends of its range.

        >>> Signal("level", "1", display_unit="%", low=0.0, high=1.2).percent_scale
        (0.0, 1.0)
        >>> Signal("pump", "V", low=-2.0, high=10.0).percent_scale
        (-2.0, 10.0)
        """
        if self.unit == "1" and self.display_unit == "%":
            return 0.0, 1.0
        return self.low, self.high

    @property
    def percent_span(self) -> float:
        """The change [unit] that 100 % of the signal are; infinite where a limit is open.

        >>> Signal("level", "1", display_unit="%", low=0.0, high=1.2).percent_span
        1.0
        """
        zero, hundred = self.percent_scale
        return hundred - zero

    @property
    def has_range(self) -> bool:
        """Whether it has the finite scale that percent are of.

        >>> Signal("level", "m", low=0.0, high=5.0).has_range, Signal("level", "m").has_range
        (True, False)
        """
        return math.isfinite(self.percent_span) and self.percent_span > 0.0

    @property
    def shown_unit(self) -> str:
        """The unit that the reader sees."""
        return self.display_unit or self.unit

    @cached_property
    def owner(self) -> str:
        """What the signal belongs to: its path but for the last part; empty for none.

        >>> Signal("tank_1.level").owner
        'tank_1'
        """
        return self.name.rpartition(".")[0]

    @cached_property
    def part(self) -> str:
        """What it is of its owner: the last part of its path.

        >>> Signal("tank_1.level").part
        'level'
        """
        return self.name.rpartition(".")[2]

    @property
    def identifier(self) -> str:
        """The name in a programming language: an identifier, or a member of a structure.

        >>> Signal("pump_1.mode").identifier
        'pump_1_mode'
        >>> Signal("pump_1.conditions.automatic", record="conditions").identifier
        'pump_1_conditions.automatic'
        """
        if self.record:
            return f"{self.variable}.{self.part}"
        return identifier(self.name)

    @property
    def port(self) -> Signal:
        """The signal as a port of a block: without value, and where real without range.

        >>> Signal("gain", low=0.0, initial=3.0).port.low
        -inf
        """
        if self.kind != "real":
            return replace(self, initial=0.0)
        return replace(self, low=-math.inf, high=math.inf, initial=0.0)

    @property
    def variable(self) -> str:
        """The identifier of the variable that holds the signal, maybe with others.

        >>> Signal("pump_1.conditions.automatic", record="conditions").variable
        'pump_1_conditions'
        """
        return identifier(self.owner if self.record else self.name)

    def to_percent(self, value: float) -> float:
        """Return a value [unit] in the signal's percent."""
        zero, hundred = self.percent_scale
        return 100.0 * (value - zero) / (hundred - zero)

    def from_percent(self, percent: float) -> float:
        """Return the value [unit] of a signal's percent."""
        zero, hundred = self.percent_scale
        return zero + (hundred - zero) * percent / 100.0


def identifier(name: str) -> str:
    """Return a path as an identifier of a programming language."""
    return name.replace(".", "_")


def path(owner: Signal | str, part: str) -> str:
    """Return the name of what belongs to something: its owner's name, a dot, its part."""
    return f"{owner if isinstance(owner, str) else owner.name}.{part}"


def effect(to: Signal | str, what: str, by: Signal | str) -> str:
    """Return the name of a number of a matrix: what one thing does to another."""
    return path(path(to, what), by if isinstance(by, str) else by.name)


def elements(name: str, count: int) -> list[str]:
    """Return the names of the elements of a vector, whose places are all that they differ in.

    Examples
    --------
    >>> elements("schedule.point", 2)
    ['schedule.point.1', 'schedule.point.2']
    """
    return [path(name, str(place)) for place in range(1, count + 1)]


def owned(owner: Signal | str, signals: Iterable[Signal]) -> list[Signal]:
    """Return signals as parts of their owner."""
    return [replace(signal, name=path(owner, signal.name)) for signal in signals]
