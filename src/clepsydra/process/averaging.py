"""Tanks that are there to smooth a flow: the key "averaging" of a process file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from clepsydra.base.signal import Signal
from clepsydra.process.element import Element
from clepsydra.process.elements.sensor import Sensor
from clepsydra.process.known_names import known_names
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

    Raises
    ------
    InputError
        A name is no controlled level or volume of a tank, or no controller moves what leaves
        the tank.
    """
    if not table.has("averaging"):
        return ()
    sensors = {element.name: element for element in elements if isinstance(element, Sensor)}
    contents = [
        name
        for name in controlled
        if name in sensors and sensors[name].measured in ("level", "volume")
    ]
    if not contents:
        expected = "no such key, since no level or volume of a tank is controlled"
        raise table.wrong("averaging", expected, "remove it, or name a level in controlled")
    names = known_names(
        contents,
        table,
        "averaging",
        expected="a list of controlled levels",
        remedy=f'write as in averaging = ["{contents[0]}"]',
        each="a controlled level or volume of a tank",
    )
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
