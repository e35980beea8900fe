"""What has to hold in a step of a task: signals, inputs and parameters within bands."""

from __future__ import annotations

import math
from dataclasses import replace

from clepsydra.base.arguments import require_known
from clepsydra.base.signal import Signal
from clepsydra.controllers.blocks.status import Mode
from clepsydra.process.process import Process
from clepsydra.process.signal_values import read_value
from clepsydra.process.table_reader import TableReader

#: Lowest and highest value [SI].
Band = tuple[float, float]
#: What is to be exact may be off by so much of it, as what is typed in another unit is.
_ROUNDING = 1e-9
_MODES = {"manual": Mode.MANUAL, "automatic": Mode.AUTOMATIC}
_WRITE = 'write as in {{ {name} = ["{low}", "{high}"] }}, or one quantity for an exact value'


def seen_signals(process: Process) -> dict[str, Signal]:
    """Return what a page sees of a run by name: all that it records, modes, and parameters.

    Examples
    --------
    >>> import clepsydra as cl
    >>> found = seen_signals(cl.load("quadruple-tank").process)
    >>> [name for name in found if name.startswith("pump_1")]
    ['pump_1', 'pump_1.mode', 'pump_1.gain']
    """
    measured = {
        name: replace(signal, name=name)
        for signal in process.measurements
        for name in (signal.name, f"{signal.name}.setpoint")
        if name == signal.name or signal.name in process.controlled
    }
    moved = {
        name: replace(signal, name=name)
        for signal in process.inputs
        for name in (signal.name, f"{signal.name}.mode")
    }
    rest = (*process.disturbances, *process.parameters)
    return measured | moved | {signal.name: signal for signal in rest}


def read_bands(table: TableReader, key: str, process: Process) -> dict[str, Band]:
    """Read a table of what has to hold: name to a value, to two ends, or to a mode.

    An end that is left empty, "", is open.

    Raises
    ------
    InputError
        A name is none of the rig, or a value no quantity of it.
    """
    if not table.has(key):
        return {}
    rows = table.table(key, "what has to hold, by name", f"write as in [{key}]")
    known = seen_signals(process)
    moved = {f"{u.name}.mode" for u in process.inputs}
    for name in rows.present:
        require_known(rows.place(name), name, list(known), f"a signal of {process.name}")
    return {
        name: _mode(rows, name) if name in moved else _band(rows, name, known[name])
        for name in rows.present
    }


def _mode(rows: TableReader, name: str) -> Band:
    mode = float(_MODES[rows.choice(name, list(_MODES), "manual")])
    return mode, mode


def _band(rows: TableReader, name: str, signal: Signal) -> Band:
    written = rows.raw(name)
    expected, remedy = "a value of", _WRITE.format(name=name, low="1", high="2")
    if not isinstance(written, list):
        value = read_value(rows, name, signal, expected, remedy)
        room = _ROUNDING * (signal.span if math.isfinite(signal.span) else abs(value))
        return value - room, value + room
    if len(written) != 2:
        raise rows.wrong(name, "a lowest and a highest value", remedy)
    low, high = (
        end
        if each == ""
        else read_value(rows.with_value(name, each), name, signal, expected, remedy)
        for each, end in zip(written, (-math.inf, math.inf), strict=True)
    )
    if not low < high:
        raise rows.wrong(name, "a lower end below the upper end", "exchange or correct them")
    return low, high
