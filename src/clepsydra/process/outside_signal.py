"""Signals from outside in a process file: what moves an actuator, and what disturbs a plant."""

from __future__ import annotations

from itertools import accumulate
from typing import Any, NamedTuple

from clepsydra.base.units import convertible
from clepsydra.process import told
from clepsydra.process.declared import part
from clepsydra.process.table_reader import TableReader

#: SI units of signals of controllers; a percentage is a pure number, 1/min a frequency.
_UNITS = ("V", "A", "1", "Hz")
# A share of the range that rounding may add where steps lead to its ends.
_ROUNDING = 1e-12


def _manipulated_signal(table: TableReader) -> dict[str, Any]:
    """Read "range" and "nominal" of an actuator, which is None where the file gives levels."""
    unit = _unit(table)
    low, high = table.range("range", unit, at_least=0.0)
    nominal = None
    if table.has("nominal"):
        expected = "a voltage" if unit == "V" else "a signal"
        remedy = f"choose a {'voltage' if unit == 'V' else 'value'} within the range"
        asked = table.of_range("nominal", unit, (low, high))
        nominal = asked.quantity("nominal", unit, expected, remedy, at_least=low, at_most=high)
    return {"unit": unit, "low": low, "high": high, "nominal": nominal}


def actuator_signal() -> Any:
    """Return the field `low` of an actuator, of which `high`, `nominal` and `unit` are filled."""
    return part(
        lambda table, key, known: _manipulated_signal(table),
        {
            "range": told.quantities("range of the signal that moves it", 2),
            "nominal": told.quantity("its signal at the operating point"),
        },
        fills=True,
        required=("range",),
    )


def _unit(table: TableReader) -> str:
    """Return the SI unit of the range; volts where the range is malformed, for its message."""
    written = table.display_units("range").get("range")
    if written is None:
        value = table.raw("range") if table.has("range") else None
        numbers = isinstance(value, list) and all(isinstance(end, int | float) for end in value)
        return "1" if numbers else "V"
    # A revolution is 2π to some and 1 to others: only 1/min and Hz mean the same to all.
    if "rpm" not in written and "rev" not in written:
        for unit in _UNITS:
            if convertible(written, unit):
                return unit
    remedy = "write the range in the unit that the controller sends"
    raise table.wrong("range", "a signal in V, mA, %, Hz, 1/min or without a unit", remedy)


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
    """

    low: float
    high: float
    nominal: float
    steps: tuple[float, ...]


def read_disturbance_range(table: TableReader, unit: str, quantity: str) -> DisturbanceRange:
    """Read the keys "range", "nominal" and "step".

    Parameters
    ----------
    unit : str
        SI unit.
    quantity : str
        In a word, "flow".
    """
    what = f"a {quantity}"
    low, high = table.range("range", unit, at_least=0.0)
    nominal = table.of_range("nominal", unit, (low, high)).quantity(
        "nominal",
        unit,
        what,
        f"choose {what} within the range",
        at_least=low,
        at_most=high,
        typical=(low + high) / 2.0,
    )
    return DisturbanceRange(low, high, nominal, _steps(table, unit, what, (low, high, nominal)))


def _steps(
    table: TableReader, unit: str, what: str, ends: tuple[float, float, float]
) -> tuple[float, ...]:
    low, high, nominal = ends
    written = table.raw("step") if table.has("step") else []
    listed = written if isinstance(written, list) else [written]
    rows = [
        table.with_value("step", each).of_range("step", unit, (low, high), change=True)
        for each in listed
    ]
    steps = tuple(row.quantity("step", unit, what, "give the size of a load step") for row in rows)
    slack = _ROUNDING * (high - low)
    for row, value in zip(rows, list(accumulate(steps, initial=nominal))[1:], strict=True):
        if not low - slack <= value <= high + slack:
            expected = "a step that stays within the range, from where the steps before it lead"
            raise row.wrong("step", expected, "make the step smaller or the range wider")
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
        lambda table, key, known: read_disturbance_range(table, unit, quantity)._asdict(),
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
