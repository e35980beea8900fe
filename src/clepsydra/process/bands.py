"""The bands in which averaging levels are kept: the key "band" of sensors, and what it may be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import from_si
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.table_reader import TableReader

if TYPE_CHECKING:
    from clepsydra.process.process import Process

_KEY = "band"


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

    Raises
    ------
    InputError
        A level with a band does not average, the band goes beyond floor or rim, or the operating
        point lies outside of it.
    """
    found = {}
    for sensor in elements:
        if not isinstance(sensor, Sensor) or sensor.band is None:
            continue
        table = TableReader(document, (sensor.table, sensor.name), None)
        if sensor.name not in averaging:
            expected = "no band, since this is none of the levels that average"
            remedy = f'remove it, or write averaging = ["{sensor.name}"] at the top of the file'
            raise table.wrong(_KEY, expected, remedy)
        least, most = map(sensor.to_reading, sensor.bounds)
        signal = sensor.measurements()[0]
        if sensor.band[0] < least or sensor.band[1] > most:
            raise table.wrong(
                _KEY,
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
