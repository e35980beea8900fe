"""Gains with their units, and values of signals."""

from __future__ import annotations

import math
from typing import Literal

from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, from_si, split_quantity, to_si
from clepsydra.design.gain_units import gain_from_percent, has_range
from clepsydra.process.table_reader import TableReader, shown_value

#: What a gain has beside the units of its signals: nothing, 1/s (integral) or s (derivative).
Time = Literal["1", "1/s", "s"]
_PERCENT = "%/%"


def read_gain(
    table: TableReader,
    key: str,
    moved: Signal,
    measured: Signal,
    *,
    expected: str,
    remedy: str,
    time: Time = "1",
    above: float | None = None,
) -> float:
    """Read a gain from one signal to another in SI units of both.

    It may be in any unit of its kind, "2 %/cm", or in percent of the range of what is moved per
    percent of the range of what is measured, "2 %/%", with a time behind it, "0.1 %/% /min". A
    number without a unit is taken where both signals have the same unit.

    Parameters
    ----------
    table : TableReader
    key : str
    moved, measured : Signal
    expected, remedy : str
        What it is and what to do where it is wrong.
    time : {"1", "1/s", "s"}
    above : float or None
        A bound that it must be above.

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> level = Signal("level", "m", low=0.0, high=5.0)
    >>> pump = Signal("pump", "V", low=0.0, high=10.0)
    >>> table = TableReader(parse(b"a = '0.02 V/cm'\\nb = '2 %/%'", "a.toml"), (), None)
    >>> [read_gain(table, key, pump, level, expected="a gain", remedy="") for key in "ab"]
    [2.0, 4.0]
    """
    text = table.raw(key) if table.has(key) else None
    parts = split_quantity(text) if isinstance(text, str) else None
    if parts is not None and parts[1].replace(" ", "").startswith(_PERCENT):
        number = _of_ranges(table, key, parts, moved, measured, time)
        if above is not None and not number > above:
            raise table.refused(key, shown_value(text), f"{expected} above {above:g}", remedy)
        return number
    unit = unit_of_gain(moved, measured, time)
    beside = {"1": "", "1/s": "/s", "s": " s"}[time]
    ranges = ""
    if has_range(moved) and has_range(measured):
        ranges = f", or in %/%{beside} of the ranges of {moved.name} and {measured.name}"
    shown = unit_of_gain(_shown(moved), _shown(measured)) + beside
    shown = "a number" if shown == "1" else f"in {shown}"
    example = f"1 %/%{beside}" if ranges else f"1 {unit}"
    check_unit(table, key, unit, f"{expected}, {shown}{ranges}", example, remedy)
    return table.quantity(key, unit, expected, remedy, above=above)


def _shown(signal: Signal) -> Signal:
    """Return a signal whose unit is the one that its reader sees."""
    return Signal(signal.name, signal.shown_unit)


def check_unit(
    table: TableReader, key: str, unit: str, expected: str, example: str, remedy: str
) -> None:
    """Refuse what is no quantity of a unit, in words about what is asked for.

    Parameters
    ----------
    table : TableReader
    key : str
    unit : str
        SI unit; "1" for a number.
    expected : str
        With the units that suit.
    example : str
        A quantity that could be written.
    remedy : str
        What to do where the key is missing.

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"to = '3 m'", "a.toml"), (), None)
    >>> check_unit(table, "to", "A", "a setpoint in mA", "12 mA", "add it")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: a.toml, line 1, to: got '3 m', expected a setpoint in mA; \
'm' is no unit of it: write as in "12 mA".
    """
    write = f'write as in "{example}"'
    if not table.has(key):
        raise table.refused(key, f"no {key}", expected, f"{remedy}: {write}")
    written = table.raw(key)
    number = isinstance(written, (int, float)) and not isinstance(written, bool)
    parts = split_quantity(written) if isinstance(written, str) else None
    if not number and parts is None:
        raise table.refused(key, table.written(key), expected, write)
    written_unit = parts[1] if parts else ""
    if not written_unit and unit != "1":
        raise table.refused(key, table.written(key), expected, f"the unit is missing: {write}")
    if written_unit and not convertible(written_unit, unit):
        problem = f"{shown_value(written_unit)!r} is no unit of it"
        raise table.refused(key, table.written(key), expected, f"{problem}: {write}")


def unit_of_gain(moved: Signal, measured: Signal, time: Time = "1") -> str:
    """Return the SI unit of a gain; "1" where the units of the signals cancel.

    Examples
    --------
    >>> flow, strength = Signal("flow", "m^3/s"), Signal("strength", "mol/m^3")
    >>> unit_of_gain(flow, strength), unit_of_gain(flow, flow, "1/s")
    ('m^3/s/(mol/m^3)', '1/s')
    """
    below = measured.unit
    unit = moved.unit
    if below != "1":
        unit = f"{unit}/({below})" if "/" in below else f"{unit}/{below}"
    if convertible(unit, "1"):
        return time
    return {"1": unit, "1/s": f"{unit}/s", "s": f"{unit}*s"}[time]


def read_value(
    table: TableReader,
    key: str,
    signal: Signal,
    expected: str,
    remedy: str,
    *,
    change: bool = False,
) -> float:
    """Read a value of a signal, or a change of it, in its SI unit.

    Of a signal that is not itself in percent, percent are those of its range.

    Parameters
    ----------
    table : TableReader
    key : str
    signal : Signal
    expected, remedy : str
    change : bool
        Whether it is a difference of two values.

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> level = Signal("level", "A", low=0.004, high=0.020)
    >>> table = TableReader(parse(b"a = '12 mA'\\nb = '50 %'", "a.toml"), (), None)
    >>> [read_value(table, key, level, "a level", "") for key in "ab"]
    [0.012, 0.012]
    """
    text = table.raw(key) if table.has(key) else None
    parts = split_quantity(text) if isinstance(text, str) else None
    if parts is not None and parts[1] == "%" and signal.unit != "1" and math.isfinite(signal.span):
        percent = 100.0 * to_si(text, "1", table.place(key))
        value = signal.from_percent(percent)
        return value - signal.low if change else value
    words, example = _of_signal(signal, change=change)
    check_unit(table, key, signal.unit, f"{expected} {words}", example, remedy)
    return table.quantity(key, signal.unit, expected, remedy)


def _of_signal(signal: Signal, *, change: bool) -> tuple[str, str]:
    """Return how a value of a signal is written, and an example."""
    unit = signal.shown_unit
    beside = "" if unit == "1" else f" {unit}"
    words = f"of {signal.name} in {unit}" if beside else f"of {signal.name}, a number"
    if not has_range(signal):
        return words, f"1{beside}"
    low, high, middle = (
        f"{from_si(each, signal.unit, unit):.6g}"
        for each in (signal.low, signal.high, signal.from_percent(50.0))
    )
    if change:
        middle = f"{from_si(0.1 * signal.span, signal.unit, unit):.4g}"
    else:
        words = f"of {signal.name} from {low} to {high}{beside}"
    return words + ("" if signal.unit == "1" else ", or in % of its range"), f"{middle}{beside}"


def read_rate(table: TableReader, key: str, signal: Signal, expected: str, remedy: str) -> float:
    """Read a largest rate of change of a signal, above zero [SI unit/s].

    Of a signal that is not itself in percent, percent are those of its range.

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> level = Signal("level", "A", low=0.004, high=0.020)
    >>> table = TableReader(parse(b"a = '0.6 mA/min'\\nb = '10 %/min'", "a.toml"), (), None)
    >>> [round(read_rate(table, key, level, "a rate", ""), 9) for key in "ab"]
    [1e-05, 2.6667e-05]
    """
    text = table.raw(key) if table.has(key) else None
    parts = split_quantity(text) if isinstance(text, str) else None
    unit = "1/s" if signal.unit == "1" else f"{signal.unit}/s"
    finite = signal.unit != "1" and math.isfinite(signal.span)
    if parts is not None and parts[1].startswith("%/") and finite:
        rate = table.quantity(key, "1/s", expected, remedy, above=0.0)
        return rate * signal.span
    shown = "1" if signal.shown_unit == "1" else signal.shown_unit
    words = f"{expected} of {signal.name}, in {shown}/min"
    words += " or %/min of its range" if finite else ""
    example = "10 %/min" if finite or shown == "%" else f"1 {shown}/min"
    check_unit(table, key, unit, words, example, remedy)
    return table.quantity(key, unit, expected, remedy, above=0.0)


def check_in_range(table: TableReader, key: str, signal: Signal, value: float, what: str) -> None:
    """Refuse a value [SI] outside the range of its signal.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"to = '6 m'", "a.toml"), (), None)
    >>> check_in_range(table, "to", Signal("level", "m", low=0.0, high=5.0), 6.0, "a setpoint")
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: a.toml, line 1, to: got '6 m', expected a setpoint from 0 to \
5 m, the range of level; stay inside the range.
    """
    if signal.low <= value <= signal.high:
        return
    unit = signal.shown_unit
    low, high, found = (
        f"{from_si(each, signal.unit, unit):.6g}" for each in (signal.low, signal.high, value)
    )
    shown = "" if unit == "1" else f" {unit}"
    asked = table.written(key)
    raise table.refused(
        key,
        f"{asked}, to {found}{shown}" if key == "by" else asked,
        f"{what} from {low} to {high}{shown}, the range of {signal.name}",
        "stay inside the range",
    )


def _of_ranges(
    table: TableReader,
    key: str,
    parts: tuple[str, str],
    moved: Signal,
    measured: Signal,
    time: Time,
) -> float:
    number, unit = parts
    rest = unit.replace(" ", "")[len(_PERCENT) :]
    for signal in (moved, measured):
        if not has_range(signal):
            raise table.refused(
                key,
                table.written(key),
                f"a gain in {unit_of_gain(moved, measured, time)}, since {signal.name} has no "
                "finite range",
                "write it in engineering units",
            )
    rest = rest.lstrip("*·")
    written = f"{number} 1{rest}" if rest.startswith("/") else f"{number} {rest}"
    percent = to_si(written.strip(), time, table.place(key))
    return gain_from_percent(percent, measured, moved)
