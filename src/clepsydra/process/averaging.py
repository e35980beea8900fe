"""Tanks that are there to smooth a flow: the key "averaging", and the bands of their levels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.known_names import known_names
from clepsydra.process.sensor_reading import CONTENTS
from clepsydra.process.table_reader import TableReader

if TYPE_CHECKING:
    from clepsydra.process.process import Process


def read_averaging(
    table: TableReader,
    controlled: Sequence[str],
    inputs: Sequence[Signal],
    elements: Sequence[Element],
) -> tuple[str, ...]:
    """Read the controlled levels that are allowed to move, so that the outflow moves less.

    Controllers of such a level are judged by what leaves the tank and not by the error of its
    level. The outflow must be a controller's to move, or there is nothing to judge.

    Parameters
    ----------
    table : TableReader
        The head of the file.
    controlled : sequence of str
        Measurements that follow setpoints.
    inputs : sequence of Signal
        What controllers move.

    Returns
    -------
    tuple of str
        Empty where the file has no such key.
    """
    if not table.has("averaging"):
        return ()
    sensors = {element.name: element for element in elements if isinstance(element, Sensor)}
    contents = [n for n in controlled if n in sensors and sensors[n].measured in CONTENTS]
    if not contents:
        expected = "no such key, since no level or volume of a tank is controlled"
        raise table.wrong("averaging", expected, "remove it, or name a level in controlled")
    expected, each = "a list of controlled levels", "a controlled level or volume of a tank"
    remedy = f'write as in averaging = ["{contents[0]}"]'
    names = known_names(contents, table, "averaging", expected=expected, remedy=remedy, each=each)
    moved = {signal.name for signal in inputs}
    for name in names:
        tank = sensors[name].tank
        if not any(_draws(element, tank) and moved & _signals(element) for element in elements):
            raise table.refused(
                "averaging",
                name,
                f"the level of a tank whose outflow a controller moves; none draws from {tank}",
                f"remove it, or manipulate a pump, valve or flow with the source {tank}",
            )
    return names


def read_bands(
    document: Document,
    elements: Sequence[Element],
    averaging: Sequence[str],
    nominal_outputs: Mapping[str, float],
) -> dict[str, tuple[float, float]]:
    """Return the lowest and the highest measurement of each averaging level that has a band.

    Parameters
    ----------
    averaging : sequence of str
        Measurements of the levels that average.
    nominal_outputs : mapping
        Measurements that fix the operating point.
    """
    found = {}
    for sensor in elements:
        if not isinstance(sensor, Sensor) or sensor.band is None:
            continue
        table = TableReader(document, (sensor.table, sensor.name), None)
        if sensor.name not in averaging:
            expected = "no band, since this is none of the levels that average"
            remedy = f'remove it, or write averaging = ["{sensor.name}"] at the top of the file'
            raise table.wrong("band", expected, remedy)
        least, most = map(sensor.to_reading, sensor.bounds)
        signal = sensor.measurements()[0]
        if sensor.band[0] < least or sensor.band[1] > most:
            raise table.wrong(
                "band",
                f"a band between the floor and the rim of {sensor.tank}, "
                f"{band_text(signal, (least, most))}",
                "correct it, or the height of the tank",
            )
        at_rest = nominal_outputs.get(sensor.name, sensor.band[0])
        if not sensor.band[0] <= at_rest <= sensor.band[1]:
            point = TableReader(document, ("operating_point",), None)
            expected, remedy = within_band(signal, sensor.band)
            raise point.wrong(sensor.name, expected, remedy)
        found[sensor.name] = sensor.band
    return found


def band_text(signal: Signal, ends: Sequence[float], digits: int = 6) -> str:
    """Return the ends of a band, or one of them, in the unit that the reader sees.

    Examples
    --------
    >>> band_text(Signal("level", "1", "%", low=0.0, high=1.0), (0.3, 0.7))
    '30 to 70 %'
    """
    unit = signal.shown_unit
    words = " to ".join(f"{from_si(end, signal.unit, unit):.{digits}g}" for end in ends)
    return words + ("" if unit == "1" else f" {unit}")


def check_at_rest(process: Process, values: Mapping[str, float]) -> None:
    """Refuse an operating point at which a level lies outside of its band.

    Parameters
    ----------
    values : mapping
        Measurements at the operating point, by name.
    """
    for name, band in process.bands.items():
        if not band[0] <= values[name] <= band[1]:
            signal = process.signal(name)
            found = band_text(signal, (values[name],))
            expected, remedy = within_band(signal, band)
            place = f"{process.address}, operating_point.{name}"
            raise InputError(place, f"{found} at rest", expected, remedy)


def within_band(signal: Signal, band: tuple[float, float]) -> tuple[str, str]:
    """Return what is expected of a setpoint that lies outside of the band, and what to do.

    Examples
    --------
    >>> within_band(Signal("level", "m", low=0.0, high=5.0), (1.5, 3.5))
    ('a setpoint within the band of level, 1.5 to 3.5 m', 'move it, or widen the band')
    """
    return (
        f"a setpoint within the band of {signal.name}, {band_text(signal, band)}",
        "move it, or widen the band",
    )


def averaged_flows(process: Process, name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the signals that move what leaves the tank of a level, and what arrives there.

    Parameters
    ----------
    name : str
        Of an averaging measurement.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> averaged_flows(load_process("equalisation-tank"), "level")
    (('outflow',), ('inflow',))
    """
    tank = next(e.tank for e in process.elements if isinstance(e, Sensor) and e.name == name)
    moved = {signal.name for signal in process.inputs}
    leaving = [e.name for e in process.elements if e.name in moved and _draws(e, tank)]
    arriving = [
        element.name
        for element in process.elements
        if any(signal.name == element.name for signal in process.disturbances)
        and any((c.key, c.name) == (("destination",), tank) for c in element.connections())
    ]
    return tuple(leaving), tuple(arriving)


def _draws(element: Element, tank: str) -> bool:
    return any(
        connection.key == ("source",) and connection.name == tank
        for connection in element.connections()
    )


def _signals(element: Element) -> set[str]:
    return {signal.name for signal in (*element.inputs(), *element.disturbances())}
