"""Times of sensors in whole sampling periods: a controller looks no more often."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from clepsydra.base.remark import Remark
from clepsydra.base.words import time_text
from clepsydra.process.document import Document
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.table_reader import TableReader

#: A dead time, and the time between two reports, in sampling periods at most.
MOST_SAMPLES = 100_000
#: Times that differ by less than this share of the sampling period are one.
_SAME = 1e-9
_KEYS = ("dead_time", "sampling", "first_report")


def in_whole_samples(
    document: Document, elements: Sequence[Element], period: float
) -> tuple[tuple[Element, ...], tuple[Remark, ...]]:
    """Return elements whose sensors have times of whole sampling periods, and where that is new.

    What a sensor tells between two samples is seen at the next one, so that for whoever looks at
    the samples a dead time is a whole number of them. It is taken to the nearest, since it is
    seldom known any better.

    Parameters
    ----------
    period : float
        Sampling period [s].

    Raises
    ------
    InputError
        A time is longer than 100,000 sampling periods.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> document = parse(b"[sensors.salt]\\ndead_time = '42 s'", "plant.toml")
    >>> sensor = Sensor("salt", "tank", low=0.0, high=1.0, unit="1", dead_time=42.0)
    >>> (rounded,), (said,) = in_whole_samples(document, [sensor], 5.0)
    >>> rounded.dead_time, said.means
    (40.0, 'it is taken as 40 s')
    """
    found, said = list[Element](), list[Remark]()
    for element in elements:
        if isinstance(element, Sensor):
            whole: dict[str, Any] = {key: _whole(document, element, key, period) for key in _KEYS}
            said += [
                _rounded(document, element, key, time, period)
                for key, time in whole.items()
                if abs(time - getattr(element, key)) > _SAME * period
            ]
            element = replace(element, **whole)
        found.append(element)
    return tuple(found), tuple(said)


def _whole(document: Document, sensor: Sensor, key: str, period: float) -> float:
    time: float = getattr(sensor, key)
    if time > MOST_SAMPLES * period:
        table = TableReader(document, (sensor.table, sensor.name), None)
        expected = f"at most {MOST_SAMPLES:,} sampling periods of {time_text(period)}"
        raise table.wrong(key, expected, "shorten it, or lengthen the sampling period")
    periods = round(time / period)
    return time if abs(periods * period - time) <= _SAME * period else periods * period


def _rounded(document: Document, sensor: Sensor, key: str, time: float, period: float) -> Remark:
    told = f"it is taken as {time_text(time, 6)}" if time else "it is taken as none"
    return Remark(
        f"{document.place(sensor.table, sensor.name, key)}: "
        f"{time_text(getattr(sensor, key), 6)} is not a whole number of sampling periods of "
        f"{time_text(period, 6)}",
        told,
        "round it, or change the sampling period",
    )
