"""The signal that moves an actuator, in the unit that the user speaks: V, mA, %, Hz, 1/min."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from clepsydra.base.units import convertible
from clepsydra.process import told
from clepsydra.process.declared import part

if TYPE_CHECKING:
    from clepsydra.process.table_reader import TableReader

#: SI units of signals; a percentage is a pure number, 1/min a frequency.
_UNITS = ("V", "A", "1", "Hz")


class ManipulatedSignal(NamedTuple):
    """Unit, range and nominal value of a signal from a controller.

    Parameters
    ----------
    unit : str
        "V", "A", "1" or "Hz".
    low, high : float
        Range [unit].
    nominal : float or None
        Value at the operating point [unit]; None where the process gives levels instead.

    Examples
    --------
    >>> ManipulatedSignal("A", 0.004, 0.02, None).unit
    'A'
    """

    unit: str
    low: float
    high: float
    nominal: float | None


def read_manipulated_signal(table: TableReader) -> ManipulatedSignal:
    """Read the keys "range" and "nominal" of an actuator.

    Raises
    ------
    InputError
        The range is none, has a unit of something else, or leaves the nominal value out.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> content = b"[valves.v]\\nrange = ['4 mA', '20 mA']\\nnominal = '12 mA'"
    >>> document = parse(content, "plant.toml")
    >>> read_manipulated_signal(TableReader(document, ("valves", "v"), None))
    ManipulatedSignal(unit='A', low=0.004, high=0.02, nominal=0.012)
    """
    unit = _unit(table)
    low, high = table.range("range", unit, at_least=0.0)
    nominal = None
    if table.has("nominal"):
        nominal = table.quantity(
            "nominal",
            unit,
            "a voltage" if unit == "V" else "a signal",
            f"choose a {'voltage' if unit == 'V' else 'value'} within the range",
            at_least=low,
            at_most=high,
        )
    return ManipulatedSignal(unit, low, high, nominal)


def actuator_signal() -> Any:
    """Return the field `low` of an actuator, of which `high`, `nominal` and `unit` are filled."""
    return part(
        lambda table, key, known: read_manipulated_signal(table),
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
    raise table.wrong(
        "range",
        "a signal in V, mA, %, Hz, 1/min or without a unit",
        "write the range in the unit that the controller sends",
    )
