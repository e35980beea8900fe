"""From one unit to another by a single operation, in any arithmetic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from clepsydra.base.units import convertible, factor_of


@dataclass(frozen=True)
class Conversion:
    """A multiplication or a division by a number.

    Parameters
    ----------
    code : {"multiply", "divide"}
    """

    code: Literal["multiply", "divide"]
    number: float

    def __call__(self, value: Any) -> Any:
        """Return a value, an array or an expression in the other unit."""
        return value * self.number if self.code == "multiply" else value / self.number


def conversion(source: str, target: str) -> Conversion | None:
    """Return how a value gets from one unit to another; None where it stays what it is.

    It is divided where the other way is a multiplication by a whole number: then the result is
    rounded once, and 62 % are 0.62 to the last bit. Units that measure different things, or that
    are none, stay as they are.

    Examples
    --------
    >>> conversion("%", "1"), conversion("m^3/s", "m^3/h")
    (Conversion(code='divide', number=100.0), Conversion(code='multiply', number=3600.0))
    >>> conversion("%/%", "1"), conversion("V", "m")
    (None, None)
    """
    # A number without a unit is not read as one.
    known, other = (target, source) if source == "1" else (source, target)
    if source == target or not convertible(known, other):
        return None
    factor = factor_of(known, other)
    factor = 1 / factor if source == "1" else factor
    if factor == 1:
        return None
    if factor.numerator == 1:
        return Conversion("divide", float(factor.denominator))
    return Conversion("multiply", float(factor))
