"""The operating point as a process file fixes it: by nominal inputs, or by measurements."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.units import from_si
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.elements.tank import Tank
from clepsydra.process.table_reader import TableReader, shown_value


def check_sensor_ranges(document: Document, elements: Sequence[Element]) -> None:
    """Refuse a sensor whose range shows nothing that its quantity can be.

    Raises
    ------
    InputError
        The range lies above the rim or below the floor of its tank, or beyond the range of the
        component that it measures.

    Examples
    --------
    A sensor whose range ends at the rim shows every level of its tank:

    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.vessels.prism import Prism
    >>> tank = Tank("tank", vessel=Prism(0.3, area=0.01))
    >>> sensor = Sensor("level", "tank", 0.0, 0.3)
    >>> check_sensor_ranges(parse(b"name = 'plant'", "plant.toml"), [tank, sensor])
    """
    for sensor, bounds in _sensors(elements).values():
        if bounds is None:
            continue
        least, most = bounds
        if sensor.to_quantity(sensor.low) >= most or sensor.to_quantity(sensor.high) <= least:
            key = "range" if sensor.zero is None else "span"
            raise InputError(
                document.place(sensor.table, sensor.name, key),
                shown_value(document.tables[sensor.table][sensor.name][key]),
                f"a {key} that shows {_several(sensor)}, from {_end(sensor, key, least)} "
                f"to {_end(sensor, key, most)}",
                f"correct the {key}"
                + (" or the gain of the sensor" if key == "range" else " of the sensor"),
            )


def read_nominal_outputs(
    document: Document, elements: Sequence[Element], manipulated: Sequence[str] | None = None
) -> dict[str, float]:
    """Return the measurements that fix the operating point, or none where the inputs do.

    Parameters
    ----------
    document : Document
    elements : sequence of Element
    manipulated : sequence of str, optional
        The inputs of the process; all pumps and valves where left out.

    Raises
    ------
    InputError
        The operating point is given twice, not at all, by too many or too few values, or by
        values that no tank can hold.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> from clepsydra.process.elements.pump import Pump
    >>> from clepsydra.process.vessels.prism import Prism
    >>> tank = Tank("tank", vessel=Prism(0.3, area=0.01))
    >>> sensor = Sensor("level", "tank", 0.0, 0.3)
    >>> text = b"[pumps.pump]\\n[operating_point]\\nlevel = '12 cm'"
    >>> pump = Pump("pump", "basin", "tank", 1e-6, 0.0, 10.0, 5.0)
    >>> read_nominal_outputs(parse(text, "plant.toml"), [tank, sensor, pump])
    {'level': 0.12}
    """
    driven = [element for element in elements if element.inputs()]
    if manipulated is None:
        manipulated = [signal.name for element in driven for signal in element.inputs()]
    given = "operating_point" in document.tables
    free = [e for e in driven if given and any(s.name in manipulated for s in e.inputs())]
    for element in driven:
        nominal = document.tables[element.table][element.name].get("nominal")
        if nominal is None and element not in free:
            raise InputError(
                document.place(element.table, element.name, "nominal"),
                "no nominal",
                "the value at the operating point",
                "add it, or give measured levels in a table [operating_point]",
            )
        if nominal is not None and element in free:
            raise InputError(
                document.place(element.table, element.name, "nominal"),
                shown_value(nominal),
                "no nominal value, since [operating_point] gives levels",
                f"remove it, or remove [operating_point], or, if no controller moves "
                f"{element.name}, list at the top of the file what one moves, manipulated = [...]",
            )
    if not given:
        return {}
    sensors = _sensors(elements)
    table = TableReader(document, ("operating_point",), sensors)
    values = {name: _reading(table, *sensors[name]) for name in table.present}
    shown = [_one(sensors[name][0]) for name in values]
    for name, quantity in zip(values, shown, strict=True):
        if shown.count(quantity) > 1:
            raise table.wrong(name, f"one value for {quantity}", "remove one of the two")
    if len(values) != len(manipulated):
        raise InputError(
            table.place(),
            f"{len(values)} values",
            f"as many values as signals are manipulated, {len(manipulated)}: "
            f"{', '.join(manipulated)}",
            "give one reading for each, from which all else follows, or list at the top of the "
            "file only what a controller moves, manipulated = [...], and give nominal to the rest",
        )
    return values


#: The least and the largest value of what a sensor measures [SI]; none for a flow.
_Bounds = tuple[float, float] | None


def _reading(table: TableReader, sensor: Sensor, bounds: _Bounds) -> float:
    """Read the value of one sensor at the operating point."""
    value = table.quantity(
        sensor.name,
        sensor.unit,
        "a measurement",
        "choose a value within the range of the sensor",
        at_least=sensor.low,
        at_most=sensor.high,
    )
    if bounds is None:
        return value
    least, most = bounds
    quantity = sensor.to_quantity(value)
    liquid = sensor.measured in ("level", "volume")
    if quantity > most or quantity < least or (liquid and quantity == least):
        limit = _end(sensor, "range", most)
        raise table.wrong(
            sensor.name,
            f"a {sensor.measured} above the floor and below the rim of {sensor.tank}, at most "
            f"{limit}"
            if liquid
            else f"a concentration of {sensor.measured} from "
            f"{_end(sensor, 'range', least)} to {limit}",
            "lower it, or correct the height of the tank"
            if liquid
            else "correct it, or the range of the component",
        )
    return value


def _end(sensor: Sensor, key: str, quantity: float) -> str:
    """Return a quantity as text in the unit of a key, which is what the sensor shows of it."""
    if key == "span":
        value, unit, shown = quantity, sensor.quantity_unit, sensor.shown_quantity_unit
    else:
        value, unit = sensor.to_reading(quantity), sensor.unit
        shown = sensor.measurements()[0].shown_unit
    number = f"{from_si(value, unit, shown):g}"
    return number if shown == "1" or value == 0.0 else f"{number} {shown}"


def _one(sensor: Sensor) -> str:
    """Return what a sensor measures; level and volume are the same."""
    if sensor.flow:
        return f"the flow of {sensor.flow}"
    if sensor.measured in ("level", "volume"):
        return sensor.tank
    return f"{sensor.measured} in {sensor.tank}"


def _several(sensor: Sensor) -> str:
    """Return the values that a sensor measures, in words."""
    if sensor.measured in ("level", "volume"):
        return f"{sensor.measured}s of {sensor.tank}"
    return f"concentrations of {sensor.measured}"


def _sensors(elements: Sequence[Element]) -> dict[str, tuple[Sensor, _Bounds]]:
    """Return every sensor with the bounds of what it measures."""
    tanks = {element.name: element for element in elements if isinstance(element, Tank)}
    return {e.name: (e, _bounds(e, tanks)) for e in elements if isinstance(e, Sensor)}


def _bounds(sensor: Sensor, tanks: dict[str, Tank]) -> _Bounds:
    if sensor.flow:
        return None
    vessel = tanks[sensor.tank].vessel
    if sensor.measured in ("level", "volume"):
        return 0.0, vessel.height if sensor.measured == "level" else vessel.capacity
    component = next(c for c in sensor.components if c.name == sensor.measured)
    return component.low, component.high
