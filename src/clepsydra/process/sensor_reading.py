"""The table of a sensor in a process file: what it measures, and on which scale it shows it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from clepsydra.base.signal import Signal
from clepsydra.base.suggestion import suggestion
from clepsydra.base.units import convertible, split_quantity
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader

#: What of a tank a sensor may measure, beside concentrations.
CONTENTS = ("level", "volume")
_SIGNALS = ("V", "A", "1")
_PER = {"m": "/m", "m^3": "/m^3", "m^3/s": " s/m^3", "kg/m^3": " m^3/kg", "mol/m^3": " m^3/mol"}


def gain_unit(signal: str, quantity: str) -> str:
    """Return the SI unit of a gain from the units of signal and quantity.

    Examples
    --------
    >>> gain_unit("V", "m"), gain_unit("A", "m^3/s"), gain_unit("1", "kg/m^3")
    ('V/m', 'A s/m^3', 'm^3/kg')
    """
    per = _PER[quantity]
    return per.strip() if signal == "1" and not per.startswith("/") else f"{signal}{per}"


def read_measured(table: TableReader) -> dict[str, str]:
    """Return what is measured, the tank where it is, and the element whose flow it is."""
    if table.has("flow"):
        for key in ("tank", "quantity", "component"):
            table.refuse((key,), f"no {key} beside a flow", "remove one of the two")
        flow = table.name("flow", "the name of an element that causes a flow")
        return {"measured": "flow", "tank": "", "flow": flow}
    tank = table.name("tank", "the name of a tank")
    if not table.has("component"):
        return {"measured": table.choice("quantity", CONTENTS, "level"), "tank": tank}
    table.refuse(("quantity",), "no quantity beside a component", "remove one of the two")
    known = [component.name for component in table.components]
    component = table.name("component", "the name of a component")
    if component not in known:
        raise table.refused(
            "component",
            component[:60],
            f"a component: {', '.join(known)}"
            if known
            else "no component, since the file has none",
            suggestion(component, known, "correct the name, or add a table [components.…]"),
        )
    return {"measured": component, "tank": tank}


def read_scale(table: TableReader, quantity: str) -> dict[str, Any]:
    """Return the scale: a gain, a span that is mapped onto the range, or the quantity itself.

    It has the SI unit of the signal and its range; with a gain that, signal per quantity in SI,
    and with a span also the quantity that it shows as `low`, `zero`.

    Parameters
    ----------
    quantity : str
        SI unit of what is measured.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.table_reader import TableReader
    >>> text = b"[sensors.a]\\nspan = ['0 cm', '25 cm']\\nrange = ['4 mA', '20 mA']"
    >>> scale = read_scale(TableReader(parse(text, "plant.toml"), ("sensors", "a"), None), "m")
    >>> scale["unit"], round(scale["gain"], 12)  # [A/m]
    ('A', 0.064)
    """
    shown = table.display_units("range")
    if table.has("gain"):
        table.refuse(("span",), "either a gain or a span", "remove one of the two")
        unit = _signal(shown.get("range", ""), _SIGNALS)
        remedy = "give the signal over what is measured"
        if (unit, quantity) == ("V", "m"):
            remedy = "give the volts that a metre of level makes"
        gain = table.quantity("gain", gain_unit(unit, quantity), "a gain", remedy, above=0.0)
        low, high = table.range("range", unit)
        return {"unit": unit, "low": low, "high": high, "gain": gain}
    if table.has("span"):
        first, last = table.range("span", quantity)
        unit = _signal(shown.get("range", ""), (*_SIGNALS, quantity))
        low, high = table.range("range", unit)
        gain = (high - low) / (last - first)
        return {"unit": unit, "low": low, "high": high, "gain": gain, "zero": first}
    if any(convertible(shown.get("range") or quantity, signal) for signal in _SIGNALS):
        ends = f'["0 {quantity}", "2 {quantity}"]'
        expected = f"a range in {quantity}, or beside a range of a signal its span"
        remedy = f"add what it measures at the ends of its range, as in span = {ends}"
        raise table.wrong("range", expected, remedy)
    low, high = table.range("range", quantity)
    return {"unit": quantity, "low": low, "high": high}


def read_share(table: TableReader, key: str, known: Mapping[str, Any]) -> float | None:
    """Return a part of the range [unit of the scale], written in % of it or in its own unit.

    It is positive, or of noise also nothing; None where the file does not say.

    Parameters
    ----------
    known : mapping
        Unit and range of the sensor.
    """
    if not table.has(key):
        return None
    parts = split_quantity(table.raw(key))
    above, at_least = (None, 0.0) if key == "noise" else (0.0, None)
    remedy = "give it in % of the range, or in the unit of the range"
    what = f"a {key}"
    width = known["high"] - known["low"]
    if known["unit"] == "1" or (parts is not None and parts[1] == "%"):
        share = table.quantity(key, "1", what, remedy, above=above, at_least=at_least, at_most=1.0)
        return share * width
    return table.quantity(
        key, known["unit"], what, remedy, above=above, at_least=at_least, at_most=width
    )


def read_band(table: TableReader, key: str, known: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the lowest and the highest measurement of a band [unit of the scale], if it has one.

    Parameters
    ----------
    known : mapping
        Quantity, unit and range of the sensor.
    """
    if not table.has(key):
        return None
    remedy = 'write as in band = ["30 %", "70 %"]'
    ends = table.raw(key)
    if not isinstance(ends, list) or len(ends) != 2:
        raise table.wrong(key, "the two ends of a band", remedy)
    unit = table.display_units("range").get("range", "")
    shown = Signal(known["measured"], known["unit"], unit, known["low"], known["high"])
    low, high = (
        read_in_range(table.with_value(key, end), key, shown, "an end of the band", remedy)
        for end in ends
    )
    if low >= high:
        expected, remedy = "a lower end below the upper end", "exchange or correct them"
        raise table.wrong(key, expected, remedy)
    return low, high


def _signal(shown: str, units: tuple[str, ...]) -> str:
    """Return the SI unit of a signal from the unit of its range; volts where it has none."""
    return next((unit for unit in units if shown and convertible(shown, unit)), "V")
