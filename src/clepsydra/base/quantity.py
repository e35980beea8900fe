"""A quantity declared on the dataclass field that holds it: unit, words, bounds and default."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from types import MappingProxyType
from typing import Any

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.key import ROLE, Key, with_units
from clepsydra.base.signal import Signal, path
from clepsydra.base.units import text_pattern


@dataclass(frozen=True)
class Quantity(Key):
    """A key that a file gives, and that becomes a parameter where it has words.

    Parameters
    ----------
    expected : str
        What a file must give: "a time constant".
    remedy : str
        What to do where it is wrong.
    strict : bool
        The lower bound itself is too low.
    at_most : str
        The field whose value it must not exceed.
    lowest : callable
        Takes the fields, returns the lower bound where that depends on them.
    absent : float
        The value that means that there is none, so that it is no parameter.
    needs, unless : str
        The field, and key, without which it has no meaning; beside which it has none.
    required : bool
        A file must give it though its field has a default.
    """

    expected: str = field(default="", kw_only=True)
    remedy: str = field(default="", kw_only=True)
    strict: bool = field(default=False, kw_only=True)
    at_most: str = field(default="", kw_only=True)
    lowest: Callable[[Mapping[str, Any]], float] | None = field(default=None, kw_only=True)
    absent: float | None = field(default=None, kw_only=True)
    needs: str = field(default="", kw_only=True)
    unless: str = field(default="", kw_only=True)
    required: bool = field(default=False, kw_only=True)

    def unit_of(self, known: Mapping[str, Any]) -> str:
        """Return its unit, in which fields stand for the roles."""
        return with_units(self.unit, {role: known[role] for role in ROLE.findall(self.unit)})

    def schema(self, default: object = MISSING, words: str = "") -> dict[str, Any]:
        """Return what an editor is told of it: text with a unit, or a number where it has none.

        Of text it knows whether number and sign are right and the unit is one of another kind.

        Parameters
        ----------
        default : object
            What it is where it is left out; `MISSING` where that is not said.
        words : str
            What it is, in the place of what is expected of it.
        """
        words = f"{words or self.expected} [{self.unit}]"
        bounds: dict[str, Any] = {}
        if self.low > -math.inf:
            words += f", {'above' if self.strict else 'at least'} {self.low:g}"
            bounds["exclusiveMinimum" if self.strict else "minimum"] = self.low
        if self.high < math.inf:
            words += f", at most {self.high:g}"
            bounds["maximum"] = self.high
        if default not in (MISSING, None, self.absent) and not self.required:
            words += f"; {default:g} if left out"
        may_be_bare = self.unit == "1" or "{" in self.unit
        pattern = text_pattern(
            self.unit,
            signed=self.low < 0.0,
            zero=self.low < 0.0 or (self.low == 0.0 and not self.strict),
        )
        kind: Any = ["string", "number"] if may_be_bare else "string"
        told = {"description": words, "type": kind, "pattern": pattern}
        return told | bounds if may_be_bare else told

    def check(self, value: Any) -> None:
        """Refuse what is no number [its unit] within its bounds."""
        inside = is_finite_number(value) and self.low <= value <= self.high
        if not inside or (self.strict and value == self.low):
            above, to = ("above", ", at most") if self.strict else ("from", " to")
            words = f"{self.expected} {above} {self.low:g}"
            words += "" if self.high == math.inf else f"{to} {self.high:g}"
            words += "" if self.unit == "1" else f" {self.unit}"
            raise InputError(self.name, value, words, self.remedy)

    def parameter(self, owner: Any, display_unit: str = "") -> Signal | None:
        """Return the parameter that it is of its owner, "pump_1.lag"; None where it is none."""
        value = getattr(owner, self.name)
        missing = self.needs and not getattr(owner, self.needs)
        if not self.words or value is None or value == self.absent or missing:
            return None
        roles = {role: getattr(owner, role) for role in ROLE.findall(self.unit + self.words)}
        return Signal(
            path(owner.name, self.name),
            self.unit_of(roles),
            display_unit,
            max(self.low, 0.0),
            self.high,
            value,
            description=f"{self.words.format(**roles)} {owner.name}",
        )


def quantity(
    unit: str,
    expected: str,
    words: str = "",
    *,
    remedy: str,
    above: float | None = None,
    at_least: float = -math.inf,
    at_most: float | str = math.inf,
    default: Any = MISSING,
    **options: Any,
) -> Any:
    """Return the field of a dataclass that holds a quantity, see `Quantity`.

    Parameters
    ----------
    unit : str
        SI unit; other fields in braces: "m^3/(s {unit})".
    expected, words : str
        What a file gives ("a time constant"), and what the parameter is of its owner ("time
        constant of"); a quantity without words is no parameter.
    above, at_least, at_most : float
        Bounds [unit]; the upper one may be the name of a field.
    default : float or None
        Of a file without the key, which must have it where neither it nor `absent` is given.
    **options
        `lowest`, `absent`, `needs`, `unless` and `required`.

    Examples
    --------
    >>> @dataclass
    ... class Heater:
    ...     name: str
    ...     unit: str
    ...     gain: float = quantity("W/{unit}", "a gain", "power per volt of", remedy="give it")
    ...     lag: float = quantity("s", "a time constant", "time constant of", above=0.0,
    ...                           absent=0.0, remedy="leave it out")
    >>> heater = Heater("heater_1", "V", 20.0)
    >>> gain, lag = quantities(Heater)
    >>> gain.parameter(heater).unit, gain.parameter(heater).description, lag.parameter(heater)
    ('W/V', 'power per volt of heater_1', None)
    """
    upper = {"at_most": at_most} if isinstance(at_most, str) else {"high": at_most}
    low = at_least if above is None else above
    default = options.get("absent", MISSING) if default is MISSING else default
    declared = Quantity(
        "",
        unit,
        words,
        low,
        expected=expected,
        remedy=remedy,
        strict=above is not None,
        **upper,
        **options,
    )
    return field(default=default, metadata={"declared": declared})


@cache
def declared(owner: type) -> Mapping[str, Any]:
    """Return what the fields of a dataclass declare, quantities with their names, by field."""
    found = {f.name: f.metadata["declared"] for f in fields(owner) if "declared" in f.metadata}
    return MappingProxyType(
        {
            name: replace(each, name=name) if isinstance(each, Quantity) else each
            for name, each in found.items()
        }
    )


def quantities(owner: type) -> list[Quantity]:
    """Return the quantities that the fields of a dataclass hold."""
    return [each for each in declared(owner).values() if isinstance(each, Quantity)]
