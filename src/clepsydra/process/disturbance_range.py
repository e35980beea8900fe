"""A signal from outside in a process file: its range, its nominal value and a load step."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


class DisturbanceRange(NamedTuple):
    """What a signal from outside may be.

    Parameters
    ----------
    low, high : float
        Range, in SI.
    nominal : float
        Value at the operating point.
    step : float
        Size of the load step of the default scenario; 0 for none.

    Examples
    --------
    >>> DisturbanceRange(0.0, 1e-5, 0.0, 2e-6).step
    2e-06
    """

    low: float
    high: float
    nominal: float
    step: float


def read_disturbance_range(table: TableReader, unit: str, quantity: str) -> DisturbanceRange:
    """Read the keys "range", "nominal" and "step".

    Parameters
    ----------
    table : TableReader
    unit : str
        SI unit.
    quantity : str
        In a word, "flow".

    Raises
    ------
    InputError
        The range begins below zero, or the nominal value or the step lead out of it.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> content = b"[flows.rain]\\nrange = ['0 l/s', '5 l/s']\\nnominal = '1 l/s'\\nstep = '2 l/s'"
    >>> table = TableReader(parse(content, "plant.toml"), ("flows", "rain"), None)
    >>> read_disturbance_range(table, "m^3/s", "flow")
    DisturbanceRange(low=0.0, high=0.005, nominal=0.001, step=0.002)
    """
    what = f"a {quantity}"
    low, high = table.range("range", unit, at_least=0.0)
    nominal = table.quantity(
        "nominal", unit, what, f"choose {what} within the range", at_least=low, at_most=high
    )
    step = table.quantity("step", unit, what, "give the size of a typical load step", default=0.0)
    if not low <= nominal + step <= high:
        raise table.refused(
            "step",
            table.written("step"),
            "a step that stays within the range",
            "make the step smaller or the range wider",
        )
    return DisturbanceRange(low, high, nominal, step)
