"""The operating point as a process file fixes it: by nominal inputs, or by measurements."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import Finding, InputError
from clepsydra.base.units import from_si
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.sensor_reading import CONTENTS
from clepsydra.process.signal_values import read_in_range
from clepsydra.process.table_reader import TableReader


def check_sensor_ranges(document: Document, elements: Sequence[Element]) -> None:
    """Refuse a sensor whose range shows nothing that its quantity can be."""
    for sensor in (each for each in elements if isinstance(each, Sensor)):
        least, most = sensor.bounds
        if sensor.to_quantity(sensor.low) < most and sensor.to_quantity(sensor.high) > least:
            continue
        key = "range" if sensor.zero is None else "span"
        several = f"concentrations of {sensor.measured}"
        if sensor.measured in CONTENTS:
            several = f"{sensor.measured}s of {sensor.tank}"
        raise TableReader(document, (sensor.table, sensor.name), None).wrong(
            key,
            f"a {key} that shows {several}, from {_end(sensor, key, least)} "
            f"to {_end(sensor, key, most)}",
            f"correct the {key}"
            + (" or the gain of the sensor" if key == "range" else " of the sensor"),
        )


def read_nominal_outputs(
    document: Document, elements: Sequence[Element], manipulated: Sequence[str]
) -> dict[str, float]:
    """Return the measurements that fix the operating point, or none where the inputs do.

    Those that are manipulated are the inputs of the process.
    """
    driven = [element for element in elements if element.inputs()]
    given = "operating_point" in document.tables
    free = [e for e in driven if given and any(s.name in manipulated for s in e.inputs())]
    for element in driven:
        table = TableReader(document, (element.table, element.name), None)
        if not table.has("nominal") and element not in free:
            remedy = "add it, or give measured levels in a table [operating_point]"
            raise table.wrong("nominal", "the value at the operating point", remedy)
        if table.has("nominal") and element in free:
            raise table.wrong(
                "nominal",
                "no nominal value, since [operating_point] gives levels",
                f"remove it, or remove [operating_point], or, if no controller moves "
                f"{element.name}, list at the top of the file what one moves, manipulated = [...]",
            )
    if not given:
        return {}
    sensors = {each.name: each for each in elements if isinstance(each, Sensor)}
    table = TableReader(document, ("operating_point",), sensors)
    values = {name: _reading(table, sensors[name]) for name in table.present}
    shown = [_one(sensors[name]) for name in values]
    for name, quantity in zip(values, shown, strict=True):
        if shown.count(quantity) > 1:
            raise table.wrong(name, f"one value for {quantity}", "remove one of the two")
    if len(values) != len(manipulated):
        raise InputError(
            table.place(),
            Finding(f"{len(values)} value{'s' if len(values) != 1 else ''}"),
            f"as many values as signals are manipulated, {len(manipulated)}: "
            f"{', '.join(manipulated)}",
            "give one reading for each, from which all else follows, or list at the top of the "
            "file only what a controller moves, manipulated = [...], and give nominal to the rest",
        )
    return values


def _reading(table: TableReader, sensor: Sensor) -> float:
    """Read the value of one sensor at the operating point, which may be in % of its range."""
    remedy = "choose a value within the range of the sensor"
    signal = sensor.measurements()[0]
    value = read_in_range(table, sensor.name, signal, "a measurement", remedy)
    least, most = sensor.bounds
    quantity, limit = sensor.to_quantity(value), _end(sensor, "range", most)
    if sensor.measured in CONTENTS and not least < quantity <= most:
        raise table.wrong(
            sensor.name,
            f"a {sensor.measured} above the floor and below the rim of {sensor.tank}, at most "
            f"{limit}",
            "lower it, or correct the height of the tank",
        )
    if not least <= quantity <= most:
        raise table.wrong(
            sensor.name,
            f"a concentration of {sensor.measured} from {_end(sensor, 'range', least)} to {limit}",
            "correct it, or the range of the component",
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
    if sensor.measured in CONTENTS:
        return sensor.tank
    return f"{sensor.measured} in {sensor.tank}"
