"""Values of signals, changes and rates of them, as a table of a file gives them."""

from __future__ import annotations

import math

from clepsydra.base.signal import Signal
from clepsydra.base.units import convertible, from_si, split_quantity, to_si, with_percent_hint
from clepsydra.base.words import digits_apart
from clepsydra.process.table_reader import TableReader, shown_value


def check_unit(
    table: TableReader, key: str, unit: str, expected: str, example: str, remedy: str
) -> None:
    """Refuse what is no quantity of a unit, in words about what is asked for.

    Parameters
    ----------
    unit : str
        SI unit; "1" for a number.
    expected : str
        With the units that suit.
    example : str
        A quantity that could be written.
    remedy : str
        What to do where the key is missing.
    """
    write = f'write as in "{example}"'
    if not table.has(key):
        raise table.wrong(key, expected, f"{remedy}: {write}")
    written = table.raw(key)
    number = isinstance(written, (int, float)) and not isinstance(written, bool)
    parts = split_quantity(written)
    if not number and parts is None:
        raise table.wrong(key, expected, write)
    written_unit = parts[1] if parts else ""
    if not written_unit and unit != "1":
        raise table.wrong(key, expected, f"the unit is missing: {write}")
    if written_unit and not convertible(written_unit, unit):
        problem = f"{shown_value(written_unit)!r} is no unit of it"
        raise table.wrong(key, expected, f"{problem}: {write}")


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
    change : bool
        Whether it is a difference of two values.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> level = Signal("level", "A", low=0.004, high=0.020)
    >>> table = TableReader(parse(b"a = '12 mA'\\nb = '50 %'", "a.toml"), (), None)
    >>> [read_value(table, key, level, "a level", "") for key in "ab"]
    [0.012, 0.012]
    """
    text = table.raw(key) if table.has(key) else None
    parts = split_quantity(text)
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
    if not signal.has_range:
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
    """
    text = table.raw(key) if table.has(key) else None
    parts = split_quantity(text)
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


def read_in_range(
    table: TableReader, key: str, signal: Signal, expected: str, remedy: str
) -> float:
    """Read a value of a signal that lies in its range, in its SI unit."""
    value = read_value(table, key, signal, expected, remedy)
    check_in_range(table, key, signal, value, expected)
    return value


def check_in_range(table: TableReader, key: str, signal: Signal, value: float, what: str) -> None:
    """Refuse a value [SI] outside the range of its signal."""
    beyond = beyond_range(signal, value, what)
    if beyond is not None:
        asked, (found, expected) = table.written(key), beyond
        raise table.refused(
            key,
            f"{asked}, to {found}" if key == "by" else asked,
            expected,
            with_percent_hint("stay inside the range", table.raw(key), signal.unit),
        )


def beyond_range(signal: Signal, value: float, what: str) -> tuple[str, str] | None:
    """Return a value [SI] beyond the range of its signal and what is expected; None inside.

    Examples
    --------
    >>> beyond_range(Signal("level", "1", "%", low=0.0, high=1.0), 1.2, "a setpoint")
    ('120 %', 'a setpoint from 0 to 100 %, the range of level')
    """
    if signal.low <= value <= signal.high:
        return None
    unit = signal.shown_unit
    shown_values = [from_si(each, signal.unit, unit) for each in (signal.low, signal.high, value)]
    digits = digits_apart(shown_values[2], *shown_values[:2], digits=6)
    low, high, found = (f"{each:.{digits}g}" for each in shown_values)
    shown = "" if unit == "1" else f" {unit}"
    if math.isinf(signal.high):
        span = f"of {low}{shown} or more"
    elif math.isinf(signal.low):
        span = f"of {high}{shown} or less"
    else:
        span = f"from {low} to {high}{shown}"
    return f"{found}{shown}", f"{what} {span}, the range of {signal.name}"
