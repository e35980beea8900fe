"""The operating point as a process file fixes it: by nominal inputs, or by measured levels."""

from __future__ import annotations

from collections.abc import Sequence

from clepsydra.base.errors import InputError
from clepsydra.base.units import from_si
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.level_sensor import LevelSensor
from clepsydra.process.table_reader import TableReader, shown_value
from clepsydra.process.tank import Tank


def check_sensor_ranges(document: Document, elements: Sequence[Element]) -> None:
    """Refuse a sensor whose range shows no level between floor and rim.

    Raises
    ------
    InputError
        The range lies above the rim or below the floor of its tank.

    Examples
    --------
    A sensor whose range ends at the rim shows every level of its tank:

    >>> from clepsydra.process.document import parse
    >>> tank, sensor = Tank("tank", 0.01, 0.3), LevelSensor("level", "tank", 0.0, 0.3, None)
    >>> check_sensor_ranges(parse(b"name = 'plant'", "plant.toml"), [tank, sensor])
    """
    for sensor, tank in _sensors(elements):
        if sensor.to_level(sensor.low) >= tank.height or sensor.high <= 0.0:
            raise InputError(
                document.place(sensor.table, sensor.name, "range"),
                shown_value(document.tables[sensor.table][sensor.name]["range"]),
                f"a range that shows levels of {tank.name}, from 0 to {_rim(sensor, tank)}",
                "correct the range or the gain of the sensor",
            )


def read_nominal_outputs(document: Document, elements: Sequence[Element]) -> dict[str, float]:
    """Return the measurements that fix the operating point, or none where the inputs do.

    Raises
    ------
    InputError
        The operating point is given twice, not at all, by too many or too few values, or by
        values that no level can have.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> tank, sensor = Tank("tank", 0.01, 0.3), LevelSensor("level", "tank", 0.0, 0.3, None)
    >>> from clepsydra.process.pump import Pump
    >>> text = b"[pumps.pump]\\n[operating_point]\\nlevel = '12 cm'"
    >>> pump = Pump("pump", "basin", "tank", 1e-6, 0.0, 10.0, 5.0)
    >>> read_nominal_outputs(parse(text, "plant.toml"), [tank, sensor, pump])
    {'level': 0.12}
    """
    driven = [element for element in elements if element.inputs()]
    with_nominal = [e for e in driven if "nominal" in document.tables[e.table][e.name]]
    if "operating_point" not in document.tables:
        for element in driven:
            if element not in with_nominal:
                raise InputError(
                    document.place(element.table, element.name, "nominal"),
                    "no nominal",
                    "the value at the operating point",
                    "add it, or give measured levels in a table [operating_point]",
                )
        return {}
    if with_nominal:
        first = with_nominal[0]
        raise InputError(
            document.place(first.table, first.name, "nominal"),
            shown_value(document.tables[first.table][first.name]["nominal"]),
            "no nominal value, since [operating_point] gives levels",
            "remove nominal from every pump, or remove [operating_point]",
        )
    sensors = {sensor.name: (sensor, tank) for sensor, tank in _sensors(elements)}
    table = TableReader(document, ("operating_point",), sensors)
    values = {name: _reading(table, *sensors[name]) for name in table.present}
    tanks = [sensors[name][1].name for name in values]
    for name, tank in zip(values, tanks, strict=True):
        if tanks.count(tank) > 1:
            raise table.refused(
                name, table.written(name), f"one value for {tank}", "remove one of the two"
            )
    if len(values) != len(driven):
        raise InputError(
            table.place(),
            f"{len(values)} values",
            f"as many values as there are pumps, {len(driven)}",
            "give one level for each pump; the other levels follow",
        )
    return values


def _reading(table: TableReader, sensor: LevelSensor, tank: Tank) -> float:
    """Read the value of one sensor at the operating point."""
    value = table.quantity(
        sensor.name,
        sensor.unit,
        "a measurement",
        "choose a value within the range of the sensor",
        at_least=sensor.low,
        at_most=sensor.high,
    )
    if not 0.0 < sensor.to_level(value) <= tank.height:
        raise table.refused(
            sensor.name,
            table.written(sensor.name),
            f"a level above the floor and below the rim of {tank.name}, at most "
            f"{_rim(sensor, tank)}",
            "lower it, or correct the height of the tank",
        )
    return value


def _rim(sensor: LevelSensor, tank: Tank) -> str:
    """Return what the sensor shows at the rim, as text with its unit."""
    shown_unit = sensor.measurements()[0].shown_unit
    value = tank.height * (1.0 if sensor.gain is None else sensor.gain)
    return f"{from_si(value, sensor.unit, shown_unit):g} {shown_unit}"


def _sensors(elements: Sequence[Element]) -> list[tuple[LevelSensor, Tank]]:
    tanks = {element.name: element for element in elements if isinstance(element, Tank)}
    return [(e, tanks[e.tank]) for e in elements if isinstance(e, LevelSensor)]
