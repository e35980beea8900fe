"""The unit of a gain, taken apart by the two signals that the gain joins."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from clepsydra.base.key import ratio_of_units
from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible

#: What a gain has beside the units of its signals: nothing, 1/s (integral) or s (derivative).
Time = Literal["1", "1/s", "s"]
#: How that is written behind them.
BESIDE: dict[Time, str] = {"1": "", "1/s": "/s", "s": " s"}
_POWER = re.compile(r"(?:[^\W\d]+|%)(?:\^\d)?")


@dataclass(frozen=True)
class JoinedUnit:
    """What a written unit of a gain is converted to.

    Parameters
    ----------
    unit : str
        The SI unit in which the number is read; a percent is 0.01 of it.
    factor : float
        From there to the SI units of both signals.
    """

    unit: str
    factor: float


def joined_unit(written: str, moved: Signal, measured: Signal, time: Time) -> JoinedUnit | None:
    """Return how a gain that is written in a unit is read; None where it joins other signals.

    What stands above the stroke has to be a unit of what is moved, and what stands below it one
    of what is measured, for "V/V" is a number, but not the gain from a level in percent to a
    pump in percent. Percent are those of each signal.

    Parameters
    ----------
    written : str
        "V/cm", "%/% min"

    Examples
    --------
    >>> level = Signal("level", "1", display_unit="%", low=0.0, high=1.2)
    >>> volts = Signal("pump", "V", low=0.0, high=15.0)
    >>> joined_unit("%/%", volts, level, "1"), joined_unit("V/V", volts, level, "1")
    (JoinedUnit(unit='1', factor=15.0), None)
    """
    for above, below in _cuts(written):
        percent = [part.count("%") == 1 for part in (above, below)]
        joined = (moved, measured)
        if not all(signal.has_range for signal, of in zip(joined, percent, strict=True) if of):
            continue
        units = ["1" if of else signal.unit for signal, of in zip(joined, percent, strict=True)]
        if any(
            _is_unit(above, times(units[0], first))
            and _is_unit(f"1/{below}", times(_inverse(units[1]), second))
            for first, second in {(time, "1"), ("1", time)}
        ):
            factor = moved.percent_span if percent[0] else 1.0
            factor /= measured.percent_span if percent[1] else 1.0
            top, bottom = (Signal("", unit) for unit in units)
            return JoinedUnit(unit_of_gain(top, bottom, time), factor)
    unit = unit_of_gain(moved, measured, time)
    return JoinedUnit(unit, 1.0) if has_units_of(written, unit) else None


def has_units_of(written: str, unit: str) -> bool:
    """Return whether a unit measures the same as another, without any that cancel of other kinds.

    Examples
    --------
    >>> has_units_of("mV/V", "V/V"), has_units_of("cm/cm", "V/V"), has_units_of("%", "1")
    (True, False, True)
    """
    plain = next((time for time in ("1", "s", "1/s") if _is_unit(unit, time)), None)
    if plain is None:
        return convertible(written, unit)
    kinds = [*_POWER.findall(unit), "s", "%"]
    powers = _POWER.findall(written)
    known = all(any(convertible(power, kind) for kind in kinds) for power in powers)
    return known and _is_unit(written, plain)


def unit_of_gain(moved: Signal, measured: Signal, time: Time = "1") -> str:
    """Return the SI unit of a gain; "1" where the units of the signals cancel.

    Examples
    --------
    >>> flow, strength = Signal("flow", "m^3/s"), Signal("strength", "mol/m^3")
    >>> unit_of_gain(flow, strength), unit_of_gain(flow, flow, "1/s")
    ('m^3/s/(mol/m^3)', '1/s')
    """
    unit = ratio_of_units(moved.unit, measured.unit)
    return times("1" if convertible(unit, "1") else unit, time)


def times(unit: str, time: str) -> str:
    """Return a unit times a time."""
    if time == "1" or unit == "1":
        return time if unit == "1" else unit
    return f"{unit}/s" if time == "1/s" else f"{unit}*s"


def _is_unit(written: str, unit: str) -> bool:
    return unit == "1" if written in ("", "1") else convertible(written, unit)


def _inverse(unit: str) -> str:
    return "1" if unit == "1" else f"1/({unit})"


def _cuts(written: str) -> Iterator[tuple[str, str]]:
    """Yield what stands above and below each stroke that is outside of brackets."""
    depth = 0
    for place, letter in enumerate(written):
        depth += (letter == "(") - (letter == ")")
        if letter == "/" and depth == 0:
            yield written[:place].strip(), written[place + 1 :].strip()
