"""A signal from outside in a process file: its range, its nominal value and its load steps."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Any, NamedTuple

from clepsydra.process import told
from clepsydra.process.declared import part

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader


# A share of the range that rounding may add where steps lead to its ends.
_ROUNDING = 1e-12


class DisturbanceRange(NamedTuple):
    """What a signal from outside may be.

    Parameters
    ----------
    low, high : float
        Range, in SI.
    nominal : float
        Value at the operating point.
    steps : tuple of float
        Sizes of the load steps of the default scenario, each from where the one before led to.

    Examples
    --------
    >>> DisturbanceRange(0.0, 1e-5, 0.0, (2e-6, -2e-6)).steps
    (2e-06, -2e-06)
    """

    low: float
    high: float
    nominal: float
    steps: tuple[float, ...]


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
        The range begins below zero, or the nominal value or a step leads out of it.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> content = b"[flows.rain]\\nrange = ['0 l/s', '5 l/s']\\nnominal = '1 l/s'\\nstep = '2 l/s'"
    >>> table = TableReader(parse(content, "plant.toml"), ("flows", "rain"), None)
    >>> read_disturbance_range(table, "m^3/s", "flow")
    DisturbanceRange(low=0.0, high=0.005, nominal=0.001, steps=(0.002,))
    """
    what = f"a {quantity}"
    low, high = table.range("range", unit, at_least=0.0)
    nominal = table.quantity(
        "nominal", unit, what, f"choose {what} within the range", at_least=low, at_most=high
    )
    return DisturbanceRange(low, high, nominal, _steps(table, unit, what, (low, high, nominal)))


def _steps(
    table: TableReader, unit: str, what: str, ends: tuple[float, float, float]
) -> tuple[float, ...]:
    low, high, nominal = ends
    written = table.raw("step") if table.has("step") else []
    listed = written if isinstance(written, list) else [written]
    rows = [table.with_value("step", each) for each in listed]
    steps = tuple(row.quantity("step", unit, what, "give the size of a load step") for row in rows)
    slack = _ROUNDING * (high - low)
    for row, value in zip(rows, list(accumulate(steps, initial=nominal))[1:], strict=True):
        if not low - slack <= value <= high + slack:
            raise row.wrong(
                "step",
                "a step that stays within the range, from where the steps before it lead",
                "make the step smaller or the range wider",
            )
    return tuple(step for step in steps if step)


def ranged(unit: str, what: str, quantity: str = "") -> Any:
    """Return the field of the low end that those of a `DisturbanceRange` follow.

    Parameters
    ----------
    unit : str
        SI unit.
    what : str
        For editors, "the rain".
    quantity : str
        In a word, for messages: "rain intensity"; as `what` where empty.
    """
    step = told.written(unit, signed=True)
    quantity = quantity or what.removeprefix("the ")
    steps = "size of the load step of studies, or a list of them, one after the other "
    return part(
        lambda table, key, known: read_disturbance_range(table, unit, quantity),
        {
            "range": told.quantities(f"range of {what} [{unit}]", 2, unit),
            "nominal": told.quantity(f"{what} at the operating point", unit),
            "step": {
                "description": f"{steps}[{unit}]; none if left out",
                "anyOf": [step, {"type": "array", "items": step}],
            },
        },
        fills=True,
        required=("range", "nominal"),
    )
