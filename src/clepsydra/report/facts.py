"""Facts about a controller in the units that its reader sees."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from clepsydra.base.section import Table
from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.controllers.controller import Controller
from clepsydra.designs.gain_units import gain_factor
from clepsydra.process.process import Process
from clepsydra.report.quantities import (
    display_factor,
    number_text,
    quantity_text,
    sensor_scale,
)

DIGITS = 4


def facts_table(title: str, facts: Iterable[tuple[str, str]]) -> Table:
    """Return facts about a part of a controller as a table without a head.

    Examples
    --------
    >>> facts_table("level by pump", [("action", "reverse")]).rows
    (('action', 'reverse'),)
    """
    return Table(title, ("", ""), tuple(facts), names=2)


def told_table(head: Sequence[str], rows: Iterable[Sequence[str]], **how: int) -> Table:
    """Return a table without the columns that tell nothing of any row.

    Parameters
    ----------
    **how
        Of `Table`.

    Examples
    --------
    >>> told_table(("loop", "K", "Td"), [("level", "3", ""), ("flow", "2", "–")]).head
    ('loop', 'K')
    """
    columns = zip(head, *rows, strict=True)
    told = [column for column in columns if set(column[1:]) - {"", "–", "nan"}]
    kept, *lines = zip(*told, strict=True)
    return Table("", kept, tuple(lines), **how)


def first_rows(table: Table, most: int, more: str) -> Table:
    """Return a table of at most so many rows, and one that says how many more there are.

    Examples
    --------
    >>> table = Table("", ("loop", "K"), (("a", "1"), ("b", "2"), ("c", "3")))
    >>> first_rows(table, 1, "{} more").rows
    (('a', '1'), ('2 more', ''))
    """
    left = len(table.rows) - most
    if left <= 0:
        return table
    rest = (more.format(left), *[""] * (len(table.head) - 1))
    return replace(table, rows=(*table.rows[:most], rest))


def known_signal(process: Process, signal: Signal) -> Signal:
    """Return a signal as the process has it, with display unit and range, or as it is.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> known_signal(load_process("wet-well"), Signal("duty")).shown_unit
    '%'
    """
    own = (process.state, process.inputs, process.disturbances, process.measurements)
    return next((s for group in own for s in group if s.name == signal.name), signal)


def own_values(parameters: Iterable[Signal], controller: Controller) -> dict[str, float]:
    """Return the settings of a part of a law by their names in it."""
    return {each.part: controller.values[each.name] for each in parameters}


def range_text(signal: Signal) -> str:
    """Return a signal's name with its range.

    Examples
    --------
    >>> range_text(Signal("level", "A", display_unit="mA", low=0.004, high=0.02))
    'level (4 to 20 mA)'
    """
    factor = display_factor(signal)
    low, high = f"{signal.low * factor:.4g}", f"{signal.high * factor:.4g}"
    if "inf" in low + high:
        return f"{signal.name} [{unit_text(signal.shown_unit) or '1'}]"
    return f"{signal.name} ({low} to {high} {unit_text(signal.shown_unit)}".strip() + ")"


def gain_unit(measurement: Signal, moved: Signal) -> str:
    """Return the unit of a gain as the reader sees it, empty for a pure number.

    Examples
    --------
    >>> level, pump = Signal("level", "A", display_unit="mA"), Signal("pump", "1", "%")
    >>> gain_unit(level, pump), gain_unit(level, Signal("flow", "m^3/s"))
    ('%/mA', '(m³/s)/mA')
    """
    above, below = (unit_text(signal.shown_unit) for signal in (moved, measurement))
    above, below = (f"({unit})" if "/" in unit else unit for unit in (above, below))
    return f"{above or '1'}/{below}" if below else above


def gain_text(value: float, measurement: Signal, moved: Signal, digits: int = DIGITS) -> str:
    """Return a gain [SI] in display units; a unit of several over itself says nothing.

    Examples
    --------
    >>> gain_text(250.0, Signal("level", "m", display_unit="cm"), Signal("pump", "V"))
    '2.500 V/cm'
    >>> gain_text(2.0, Signal("flow", "m^3/s"), Signal("flow_out", "m^3/s"))
    '2.000'
    """
    shown = number_text(value * gain_factor(measurement, moved), digits)
    alike = measurement.shown_unit == moved.shown_unit and "/" in moved.shown_unit
    return shown if alike else f"{shown} {gain_unit(measurement, moved)}".strip()


def level_words(process: Process, measurement: Signal, value: float) -> str:
    """Return a measurement's value, and the level that it stands for where that is another.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> level_words(process, process.signal("level_1"), 6.0)
    '6.000 V = 12.00 cm'
    """
    words = quantity_text(measurement, value, DIGITS)
    state = process.measured_state.get(measurement.name)
    if state is None or process.signal(state).shown_unit == measurement.shown_unit:
        return words
    level = float(sensor_scale(process, measurement.name).to_state(value))  # type: ignore[arg-type]
    return f"{words} = {quantity_text(process.signal(state), level, DIGITS)}"
