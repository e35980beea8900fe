"""The units that process files are usually written in, and what each is in SI units.

They are at hand in a millisecond; Pint, which knows thousands, takes a fifth of a second to load.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from typing import NamedTuple


class Unit(NamedTuple):
    """A unit in terms of SI units.

    Parameters
    ----------
    factor : Fraction
        How many of the SI unit it is, exactly.
    powers : tuple of int
        Of metre, kilogram, second, ampere and mole.
    """

    factor: Fraction
    powers: tuple[int, ...]

    def times(self, other: Unit, power: int) -> Unit:
        """Return the product with a power of another unit."""
        powers = (a + power * b for a, b in zip(self.powers, other.powers, strict=True))
        return Unit(self.factor * other.factor**power, tuple(powers))


_ONE = Unit(Fraction(1), (0, 0, 0, 0, 0))
_METRE = Unit(Fraction(1), (1, 0, 0, 0, 0))
_SECOND = Unit(Fraction(1), (0, 0, 1, 0, 0))

#: Names and symbols of what takes a prefix: the name a name of a prefix, the symbol a symbol.
_METRIC = {
    ("meter metre", "m"): _METRE,
    ("gram", "g"): Unit(Fraction(1, 1000), (0, 1, 0, 0, 0)),
    ("second", "s sec"): _SECOND,
    ("ampere", "A"): Unit(Fraction(1), (0, 0, 0, 1, 0)),
    ("mole", "mol"): Unit(Fraction(1), (0, 0, 0, 0, 1)),
    ("volt", "V"): Unit(Fraction(1), (2, 1, -3, -1, 0)),
    ("hertz", "Hz"): Unit(Fraction(1), (0, 0, -1, 0, 0)),
    ("liter litre", "l L"): Unit(Fraction(1, 1000), (3, 0, 0, 0, 0)),
}
_PREFIXES = {
    ("micro", "µ μ u"): Fraction(1, 10**6),
    ("milli", "m"): Fraction(1, 1000),
    ("centi", "c"): Fraction(1, 100),
    ("deci", "d"): Fraction(1, 10),
    ("hecto", "h"): Fraction(100),
    ("kilo", "k"): Fraction(1000),
}
_INCH = Unit(Fraction(254, 10_000), _METRE.powers)
_OTHERS = {
    ("percent", "%"): Unit(Fraction(1, 100), _ONE.powers),
    ("inch", "in"): _INCH,
    ("foot", "ft feet"): Unit(12 * _INCH.factor, _METRE.powers),
    ("gallon", "gal"): Unit(231 * _INCH.factor**3, (3, 0, 0, 0, 0)),
    ("minute", "min"): Unit(Fraction(60), _SECOND.powers),
    ("hour", "h hr"): Unit(Fraction(3600), _SECOND.powers),
    ("day", "d"): Unit(Fraction(86_400), _SECOND.powers),
}

_US_GALLON, _FOOT = _OTHERS["gallon", "gal"], _OTHERS["foot", "ft feet"]
#: Flows that people write in a word, of which Pint knows none: to it cfm is a length.
FLOWS = {
    "gpm GPM": _US_GALLON.times(_OTHERS["minute", "min"], -1),
    "mgd MGD": _US_GALLON.times(_OTHERS["day", "d"], -1)._replace(
        factor=_US_GALLON.factor * 10**6 / 86_400
    ),
    "lpm LPM": _METRIC["liter litre", "l L"].times(_OTHERS["minute", "min"], -1),
    "cfm CFM": _ONE.times(_FOOT, 3).times(_OTHERS["minute", "min"], -1),
    "cfs CFS": _ONE.times(_FOOT, 3).times(_SECOND, -1),
}

#: A name with its power, an operator or a bracket, or the blank that stands for a product.
_TOKEN = re.compile(
    r"(?P<name>[A-Za-zµμ%]+)(?: *(?:\^|\*\*) *(?P<power>-?[1-9]))?"
    r"| *(?P<sign>[*·/]) *| *(?P<close>\))|(?P<open>\() *| +"
)
_NUMBER_ONE = re.compile(r"1 *(?=/|\Z)")


@cache
def usual_units() -> dict[str, Unit]:
    """Return the usual units by every name, symbol, plural and prefix that is read at once.

    Examples
    --------
    >>> usual_units()["cm"]
    Unit(factor=Fraction(1, 100), powers=(1, 0, 0, 0, 0))
    """
    found = {}
    plain = {("", ""): Fraction(1)}
    for units, prefixes in ((_METRIC, plain | _PREFIXES), (_OTHERS, plain)):
        for (names, symbols), unit in units.items():
            for (prefix, signs), times in prefixes.items():
                scaled = unit._replace(factor=times * unit.factor)
                for name in names.split():
                    found[f"{prefix}{name}"] = found[f"{prefix}{name}s"] = scaled
                for sign in signs.split() or [""]:
                    found |= {f"{sign}{symbol}": scaled for symbol in symbols.split()}
    return found | {name: unit for names, unit in FLOWS.items() for name in names.split()}


def usual_unit(text: str) -> Unit | None:
    """Return what a product of powers of usual units is; None of any other text.

    A product and a quotient bind alike, from left to right.

    Examples
    --------
    >>> usual_unit("1/min").factor, usual_unit("bar") is None
    (Fraction(1, 60), True)
    >>> usual_unit("cm^3/(s V)").powers, usual_unit("cm^3/s V").powers
    ((1, -1, 2, 1, 0), (5, 1, -4, -1, 0))
    """
    text = text.strip(" ")
    one = _NUMBER_ONE.match(text)
    position = one.end() if one else 0
    found, power, after_factor = _ONE, 1, one is not None
    outside: list[tuple[Unit, int]] = []  # of each open bracket: what stands before it
    while position < len(text):
        token = _TOKEN.match(text, position)
        if token is None or after_factor is bool(token["name"] or token["open"]):
            return None
        position = token.end()
        if token["name"]:
            unit = usual_units().get(token["name"])
            if unit is None:
                return None
            found = found.times(unit, power * int(token["power"] or 1))
            after_factor = True
        elif token["open"]:
            outside.append((found, power))
            found, power = _ONE, 1
        elif token["close"]:
            if not outside:
                return None
            inside = found
            found, power = outside.pop()
            found = found.times(inside, power)
        else:
            power, after_factor = -1 if token["sign"] == "/" else 1, False
    return found if after_factor and not outside else None
