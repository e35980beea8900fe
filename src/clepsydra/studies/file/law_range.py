"""Numbers that a law cannot take, told in the unit that they were written in."""

from __future__ import annotations

from clepsydra.base.signal import Signal
from clepsydra.base.units import split_quantity
from clepsydra.controllers.plant_shell.edge import at_port
from clepsydra.process.table_reader import TableReader


def check_law_range(table: TableReader, key: str, parameter: Signal, value: float) -> None:
    """Refuse the value of a parameter outside of what its law takes.

    Parameters
    ----------
    table : TableReader
        With a quantity at `key`.
    parameter : Signal
        Of the law.
    value : float
        What was read [its unit].

    Raises
    ------
    InputError

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"lag = '1e6 h'", "a.toml"), (), None)
    >>> check_law_range(table, "lag", Signal("feedforward.rain.lag", "s", low=0.0, high=1e9), 3.6e9)
    Traceback (most recent call last):
        ...
    clepsydra.base.errors.InputError: a.toml, line 1, lag: got '1e6 h', expected a value from 0 to \
2.778e+05 h; correct the number or its unit.
    """
    if parameter.low <= value <= parameter.high:
        return
    if value:
        ends = parameter.low, parameter.high
        low, high = (in_written_unit(table, key, value, end) for end in ends)
    else:  # zero does not tell the size of its unit
        port = at_port(parameter)
        low, high = (f"{end:g} {port.unit}".removesuffix(" 1") for end in (port.low, port.high))
    if parameter.low == -parameter.high:
        expected = f"a size of at most {high.lstrip('-')}"
    else:
        expected = f"a value from {low.partition(' ')[0]} to {high}"
    raise table.wrong(key, expected, "correct the number or its unit")


def in_written_unit(table: TableReader, key: str, value: float, shown: float) -> str:
    """Return a number in the unit of the quantity at a key, which was read as `value`, not zero.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> table = TableReader(parse(b"time = '2 h'", "a.toml"), (), None)
    >>> in_written_unit(table, "time", 7200.0, 600.0)
    '0.1667 h'
    """
    written = table.raw(key)
    parts = split_quantity(written if isinstance(written, str) else repr(written))
    assert parts is not None  # a quantity was read of it
    number, unit = parts
    return f"{shown * float(number) / value:.4g} {unit}".strip()
