"""Units at the edge: text with a unit in, SI numbers inside, and back for the reader.

Conversion factors are exact fractions, so the only rounding is the one to the nearest double:
"28 cm^2" is the number that Python writes 0.0028, in both directions.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.usual_units import usual_unit

if TYPE_CHECKING:
    import pint

#: Units that are often written, of a kind each, the SI unit first.
_OFTEN_WRITTEN = (
    *("1 %", "m cm mm", "m^2 cm^2", "m^3 l", "m^3/s m^3/h l/s l/min l/h cm^3/s", "m/s", "V"),
    *("A mA", "s min h", "1/s 1/h", "kg", "kg/m^3 g/l", "mol", "mol/m^3"),
)
_NUMBER = re.compile(
    r" *([+-]?(?:(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?|nan\b|inf(?:inity)?\b)) *(.*?) *",
    re.IGNORECASE | re.ASCII,
)
# A unit is names, one-digit powers, products, quotients and brackets. Anything more, such as
# a power of a power, could keep a parser busy for ever.
_UNIT_TOKEN = re.compile(
    r" *(?:[A-Za-zµμΩ°%_][A-Za-z0-9µμΩ°_]*(?: *(?:\^|\*\*) *[-+]?[0-9](?![\w.^]| *\*\*))?"
    r"|\*(?!\*)|[/()·])"
)
#: What follows the whole part of "3,5 V".
_DECIMAL_COMMA = re.compile(r",(\d+) *(.*)", re.ASCII)
#: Where "cm2" lacks its "^"; no name of a unit ends in one of these digits.
_UNMARKED_POWER = re.compile(r"(?<=[A-Za-z])(?=[2-9](?!\w))", re.ASCII)
_LONGEST_TEXT = 120
_LONGEST_UNIT = 60


def split_quantity(text: object) -> tuple[str, str] | None:
    """Split text into its number and its unit; None for what is none or begins with no number.

    The powers in the unit are marked with "^", however they were written.

    Examples
    --------
    >>> split_quantity("3.33 cm^3/(s V)")
    ('3.33', 'cm^3/(s V)')
    >>> split_quantity("50%"), split_quantity("2 m3/h"), split_quantity("2 m³/h")
    (('50', '%'), ('2', 'm^3/h'), ('2', 'm^3/h'))
    """
    if not isinstance(text, str) or len(text) > _LONGEST_TEXT:
        return None
    match = _NUMBER.fullmatch(text)
    return (match[1], _with_marked_powers(match[2])) if match else None


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
        The value [`unit`], the double nearest to what was written.

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
    expected = "a number without a unit" if unit == "1" else f"a quantity convertible to {unit}"
    example = "write a number, for example 0.7" if unit == "1" else f"write it as in '1 {unit}'"
    if isinstance(text, bool) or not isinstance(text, (int, float, str)):
        raise InputError(place, text, expected, example)
    parts = split_quantity(text if isinstance(text, str) else repr(text))
    if parts is None:
        raise InputError(place, _shortened(text), expected, example)
    number, unit_text = parts
    decimals = _DECIMAL_COMMA.match(unit_text)
    if decimals is not None:
        point = f"{number}.{decimals[1]} {decimals[2]}".strip()
        raise InputError(place, text, expected, f'write decimals with a point, as in "{point}"')
    if not math.isfinite(float(number)):
        raise InputError(place, text, f"{expected}, finite", example)
    if not unit_text and unit != "1":
        raise InputError(place, text, expected, f"the unit is missing: {example}")
    factor = Fraction(1)
    if unit_text:
        factor = _factor_of_user(unit_text, unit, text, place, expected, example)
    if float(number) == 0.0:
        return 0.0
    try:
        return float(Fraction(number) * factor)
    except OverflowError:
        raise InputError(place, text, f"{expected}, finite", example) from None


def with_percent_hint(remedy: str, written: object, unit: str) -> str:
    """Return a remedy for a number that is too large, and more where it may be meant in percent.

    Parameters
    ----------
    written : object
        The number as the user wrote it.
    unit : str
        The SI unit expected.

    Examples
    --------
    >>> with_percent_hint("stay inside the range", 50, "1")
    'stay inside the range; 50 percent is written "50 %"'
    >>> with_percent_hint("stay inside the range", "50 %", "1")
    'stay inside the range'
    """
    number = split_quantity(str(written).strip())
    if unit != "1" or number is None or number[1] or not 2.0 <= float(number[0]) <= 100.0:
        return remedy
    return f'{remedy}; {number[0]} percent is written "{number[0]} %"'


def from_si(value: float, unit: str, display_unit: str) -> float:
    """Convert a value from its SI unit to the unit that the reader sees.

    The value is taken for the shortest decimal that names it, so that what a user wrote comes
    back as it was written: 0.007 m is 0.7 cm and not 0.7000000000000001 cm.

    Examples
    --------
    >>> from_si(0.124, "m", "cm")
    12.4
    """
    if unit == display_unit or not math.isfinite(value):
        return value
    return float(Fraction(repr(float(value))) / factor_of(display_unit, unit))


def unit_text(unit: str) -> str:
    """Return a unit as it is printed, empty for a pure number.

    Examples
    --------
    >>> unit_text("cm^3/(s V)"), unit_text("1")
    ('cm³/(s V)', '')
    """
    if unit in ("1", "dimensionless"):
        return ""
    return unit.replace("**", "^").replace("^2", "²").replace("^3", "³")


def convertible(unit: str, to: str) -> bool:
    """Return whether one unit measures the same as another; False where it is no unit at all.

    Examples
    --------
    >>> convertible("kmol/m^3", "mol/m^3"), convertible("kmol/m^3", "kg/m^3")
    (True, False)
    """
    try:
        factor_of(unit, to)
    except ValueError:
        return False
    return True


def text_pattern(unit: str, *, signed: bool, zero: bool) -> str:
    """Return the regular expression of text with a number and its unit, for a JSON Schema.

    It refuses a number without a unit and the usual units of another kind; any other unit, which
    it cannot know, is let pass.

    Parameters
    ----------
    unit : str
        SI unit; any is let pass of one with a role, "m/{output}".
    signed, zero : bool
        The number may be negative; it may be zero.

    Examples
    --------
    >>> area = text_pattern("m^2", signed=False, zero=False)
    >>> [bool(re.search(area, text)) for text in ("28 cm^2", "1 acre", "28 cm", "28", "-1 m^2")]
    [True, True, False, False, False]
    """
    number = ("[+-]?" if signed else r"\+?") + ("" if zero else r"(?=[\d.]*[1-9])")
    number += r"(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?(?![\d.,eE])"
    if "{" in unit:
        return f"^ *{number}.*$"
    others = " ".join(kind for kind in _OFTEN_WRITTEN if kind.split()[0] != unit)
    others = re.escape(others).replace(r"\ ", "|")
    return f"^ *{number} *((?!({others}) *$)\\S.*){'?' if unit == '1' else ''}$"


def _factor_of_user(
    unit_text: str, unit: str, text: object, place: str, expected: str, example: str
) -> Fraction:
    """Return the factor from a unit as a user wrote it, or say what is wrong with it."""
    try:
        return factor_of(unit_text, unit)
    except UnknownUnit:
        problem = f"the unit {unit_text!r} is unknown"
    except OtherKind:
        problem = f"{unit_text!r} measures something else"
        if unit == "m" and convertible(unit_text, "Pa"):
            problem = f"{unit_text!r} is a pressure, and what is asked for is a height of liquid"
            example = f"{example} or '1 in'"
    except ValueError:
        problem = f"{_shortened(unit_text)!r} cannot be used as a unit"
    raise InputError(place, text, expected, f"{problem}: {example}") from None


class UnknownUnit(ValueError):
    """A name that is that of no unit."""


class OtherKind(ValueError):
    """Two units that measure different things."""


@cache
def factor_of(source: str, target: str) -> Fraction:
    """Return the exact factor from one unit to another.

    Raises
    ------
    UnknownUnit, OtherKind
        There is none.
    ValueError
        The text is not a product of powers of units, or the scale does not begin at zero.
    """
    source = _with_marked_powers(source)
    remainder = re.sub(r"\A *1 *(?=/)", "", source)
    if len(source) > _LONGEST_UNIT or _UNIT_TOKEN.sub("", remainder).strip(" "):
        raise ValueError(source)
    found, wanted = usual_unit(source), usual_unit(target)
    if found is None or wanted is None:
        return _factor_by_pint(source, target)
    if found.powers != wanted.powers:
        raise OtherKind(source)
    return found.factor / wanted.factor


def _with_marked_powers(unit: str) -> str:
    return _UNMARKED_POWER.sub("^", unit.replace("²", "^2").replace("³", "^3"))


def _factor_by_pint(source: str, target: str) -> Fraction:
    import pint

    registry = _pint_units()
    target = "dimensionless" if target == "1" else target
    try:
        unit = registry.Unit(source)
        zero, one = (
            Fraction(registry.Quantity(Fraction(number), unit).to(registry.Unit(target)).magnitude)
            for number in (0, 1)
        )
    except pint.UndefinedUnitError as error:
        raise UnknownUnit(source) from error
    except pint.DimensionalityError as error:
        raise OtherKind(source) from error
    except Exception as error:  # Pint's parser raises many kinds on malformed unit text
        raise ValueError(source) from error
    if zero != 0:  # degrees Celsius or Fahrenheit: no factor converts them
        raise ValueError(source)
    return one


@cache
def _pint_units() -> pint.UnitRegistry:
    import pint

    registry: pint.UnitRegistry = pint.UnitRegistry(non_int_type=Fraction)
    return registry


def _shortened(text: object) -> object:
    return text[:40] + "…" if isinstance(text, str) and len(text) > 40 else text
