"""A key: one quantity of a thing, declared once, for whatever it may belong to."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from clepsydra.base.signal import Kind, Signal, path

#: A signal, or a field, by the part that it plays.
ROLE = re.compile(r"{(\w+)}")


@dataclass(frozen=True)
class Key:
    """A quantity of a block, a law or an element: its unit, its words and its bounds.

    Unit and words speak of signals by the roles that they play, in braces; what they are is known
    where the quantity belongs to something. The port of a block, the parameter of a law and the
    row of a table follow from it.

    Parameters
    ----------
    name : str
        What it is of its owner.
    unit : str
        SI unit; "{output}/{measurement}" for an output's for each of a measurement's.
    words : str
        One phrase: "gain from {measurement} to {output}".
    low, high : float
        Bounds [unit].
    default : float
        [unit]
    like : str
        The role whose range and value at rest it has in the place of those.
    kind : {"real", "integer", "boolean"}
    digits : int
        Significant digits that a design gives to it.
    below : str
        The key of the same owner that it has to be below, if there is one.
    bolder : float
        As of `Signal`.

    Examples
    --------
    >>> gain = Key("gain", "{output}/{measurement}", "gain from {measurement} to {output}")
    >>> level, pump = Signal("level_1", "m", "cm"), Signal("pump_1", "1", "%")
    >>> found = gain.of("level_1", measurement=level, output=pump)
    >>> found.name, found.unit, found.display_unit, found.description
    ('level_1.gain', '1/m', '%/cm', 'gain from level_1 to pump_1')
    >>> gain.port.name, gain.port.unit, gain.port.description
    ('gain', '1', 'gain from measurement to output')
    """

    name: str
    unit: str = "1"
    words: str = ""
    low: float = -math.inf
    high: float = math.inf
    default: float = 0.0
    like: str = ""
    kind: Kind = "real"
    digits: int = field(default=6, repr=False)
    below: str = field(default="", repr=False)
    bolder: float = field(default=0.0, repr=False)

    def of(self, owner: Signal | str, default: float | None = None, /, **roles: Signal) -> Signal:
        """Return the quantity of an owner, empty for none, with the signals that play the roles.

        Parameters
        ----------
        default : float, optional
            In the place of the key's own [unit].
        """
        shown = {role: signal.shown_unit for role, signal in roles.items()}
        held = {role: signal.unit for role, signal in roles.items()}
        unit, display_unit = with_units(self.unit, held), with_units(self.unit, shown)
        same = roles.get(self.like)
        low, high, own = (same.low, same.high, same.initial) if same else self.bounds
        return Signal(
            path(owner, self.name) if owner else self.name,
            unit,
            "" if display_unit == unit else display_unit,
            low,
            high,
            own if default is None else default,
            self.kind,
            self.words.format(**{role: signal.name for role, signal in roles.items()}),
            self.digits,
            below=self.below,
            bolder=self.bolder,
        )

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Low, high and default [unit]."""
        return self.low, self.high, self.default

    @property
    def port(self) -> Signal:
        """The quantity as a port of a block, which has no unit of a process and no range."""
        roles = {role: Signal(role) for role in ROLE.findall(self.unit + self.words)}
        return self.of("", **roles).port


def with_units(unit: str, units: dict[str, str]) -> str:
    """Return a unit in which the units of signals stand for their roles.

    Examples
    --------
    >>> roles = {"output": "V", "measurement": "m"}
    >>> with_units("{output}/({measurement} s)", roles), with_units("s {output}", roles)
    ('V/(m s)', 's V')
    >>> with_units("{output}/{measurement}", {"output": "m^3/s", "measurement": "mol/m^3"})
    'm^3/s/(mol/m^3)'
    """
    above, _, below = unit.partition("/")
    over, under = (
        [known for part in side.strip("()").split() if (known := part.format(**units)) != "1"]
        for side in (above, below)
    )
    return ratio_of_units(" ".join(over) or "1", *under)


def ratio_of_units(numerator: str, *denominators: str) -> str:
    """Return the unit of a gain.

    Examples
    --------
    >>> ratio_of_units("V", "m"), ratio_of_units("V", "V"), ratio_of_units("V", "V", "s")
    ('V/m', 'V/V', 'V/(V s)')
    >>> ratio_of_units("m^3/s", "mol/m^3")
    'm^3/s/(mol/m^3)'
    """
    below = [f"({unit})" if "/" in unit else unit for unit in denominators if unit != "1"]
    if not below:
        return numerator
    return f"{numerator}/({' '.join(below)})" if len(below) > 1 else f"{numerator}/{below[0]}"
