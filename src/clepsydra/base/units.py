"""Units at the edge: text with a unit in, SI numbers inside, and back for the reader."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError

if TYPE_CHECKING:
    import pint


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    registry: pint.UnitRegistry = pint.UnitRegistry(autoconvert_offset_to_baseunit=True)
    return registry


def to_si(text: object, unit: str, place: str) -> float:
    """Read a quantity such as ``"28 cm^2"`` and return its value in an SI unit.

    Parameters
    ----------
    text : object
        The quantity as written: text with a number and a unit. A bare number is accepted
        only where `unit` is "1".
    unit : str
        The SI unit expected, e.g. "m^2", "m^3/s", "V", "m^3/(s V)"; "1" for a pure number.
    place : str
        Where the quantity stands, for the message.

    Returns
    -------
    float
        The value [`unit`].

    Raises
    ------
    InputError
        The text has no number, no unit, an unknown unit or a unit of another dimension, or
        the number is not finite.

    Examples
    --------
    >>> to_si("0.5 V/cm", "V/m", "sensor gain")
    50.0
    >>> to_si("28 cm^2", "m^2", "tank area")
    0.0028
    """
    import pint

    expected = "a number without a unit" if unit == "1" else f"a quantity convertible to {unit}"
    example = "0.7" if unit == "1" else f"1 {unit}"
    remedy = f"write a number and a unit, for example '{example}'"
    if isinstance(text, bool) or not isinstance(text, (int, float, str)):
        raise InputError(place, text, expected, remedy)
    if isinstance(text, (int, float)):
        if unit != "1":
            raise InputError(place, text, expected, f"the unit is missing: {remedy}")
        value = float(text)
    else:
        if len(text) > 200:
            raise InputError(place, text[:40] + "…", expected, remedy)
        number, _, unit_text = text.strip().partition(" ")
        try:
            value = float(number)
        except ValueError:
            raise InputError(place, text, expected, remedy) from None
        factor = _factor(unit_text.strip() or "dimensionless", unit, text, place, expected, remedy)
        value = _scaled(value, factor)
    if not math.isfinite(value):
        raise InputError(place, text, f"{expected}, finite", remedy)
    return value


def _factor(
    unit_text: str, unit: str, text: str, place: str, expected: str, remedy: str
) -> float:
    import pint

    try:
        factor = _conversion_factor(unit_text, unit)
    except pint.UndefinedUnitError:
        raise InputError(place, text, expected, f"the unit '{unit_text}' is unknown: {remedy}") from None
    except pint.DimensionalityError:
        raise InputError(
            place, text, expected, f"'{unit_text}' measures something else: {remedy}"
        ) from None
    except Exception as error:  # Pint's parser raises many kinds on malformed unit text
        raise InputError(place, text, expected, remedy) from error
    return factor


@cache
def _conversion_factor(source: str, target: str) -> float:
    registry = _registry()
    target = "dimensionless" if target == "1" else target
    return float((1.0 * registry.Unit(source)).to(registry.Unit(target)).magnitude)


def _scaled(value: float, factor: float) -> float:
    """Multiply so that decimal prefixes stay exact: 28 cm² is 0.0028 m², not 0.0028000000000000004."""
    inverse = 1.0 / factor
    rounded = float(round(inverse))
    if rounded >= 1.0 and abs(inverse - rounded) < 1e-9 * rounded:
        return value / rounded
    return value * factor


def from_si(value: float, unit: str, display_unit: str) -> float:
    """Convert a value from its SI unit to the unit that the reader sees.

    Examples
    --------
    >>> from_si(0.124, "m", "cm")
    12.4
    """
    if unit == display_unit:
        return value
    factor = _conversion_factor(display_unit, unit)
    inverse = 1.0 / factor
    rounded = float(round(inverse))
    if rounded >= 1.0 and abs(inverse - rounded) < 1e-9 * rounded:
        return value * rounded
    return value / factor
