"""Gains with their units, as a table of a file gives them."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.base.units import (
    split_quantity,
    to_si,
)
from clepsydra.process.joined_unit import BESIDE, Time, joined_unit, unit_of_gain
from clepsydra.process.signal_values import check_unit
from clepsydra.process.table_reader import TableReader, shown_value


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

    Its unit is one of what is moved over one of what is measured, "0.3 V/cm", and percent are
    those of each signal, "2 %/cm" or "2 %/%", with a time behind it, "0.1 %/% /min". A number
    without a unit is taken where both signals have the same unit.

    Parameters
    ----------
    expected, remedy : str
        What it is and what to do where it is wrong.
    above : float or None
        A bound that it must be above.

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
    parts = split_quantity(text)
    unit = unit_of_gain(moved, measured, time)
    if parts is None or not parts[1]:
        words, example = _of_gain(expected, moved, measured, time)
        check_unit(table, key, unit, words, example, remedy)
        return table.quantity(key, unit, expected, remedy, above=above)
    found = joined_unit(parts[1], moved, measured, time)
    if found is None:
        words, example = _of_gain(expected, moved, measured, time)
        problem = (
            f"{parts[1]!r} does not join {moved.name} in {moved.shown_unit} to {measured.name} in "
            f"{measured.shown_unit}"
        )
        raise table.wrong(key, words, f'{problem}: write as in "{example}"')
    number = to_si(text, found.unit, table.place(key)) * found.factor
    if above is not None and not number > above:
        raise table.refused(key, shown_value(text), f"{expected} above {above:g}", remedy)
    return number


def _of_gain(expected: str, moved: Signal, measured: Signal, time: Time) -> tuple[str, str]:
    """Return what a gain may be written in, and an example."""
    beside = BESIDE[time]
    shown = unit_of_gain(_shown(moved), _shown(measured)) + beside
    shown = "a number" if shown == "1" else f"in {shown}"
    for signal in (moved, measured):
        if not signal.has_range:
            words = f"{expected}, {shown}, since {signal.name} has no finite range"
            return words, f"1 {unit_of_gain(moved, measured, time)}"
    words = f"{expected}, {shown}, or in %/%{beside} of {moved.name} and {measured.name}"
    return words, f"1 %/%{beside}"


def _shown(signal: Signal) -> Signal:
    """Return a signal whose unit is the one that its reader sees."""
    return Signal(signal.name, signal.shown_unit)
