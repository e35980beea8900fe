"""Arguments that are angles or angular frequencies, whose units are numbers to a computer."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from clepsydra.base.units import split_quantity
from clepsydra.designs.arguments.argument import Argument, argument

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

_ANGLES = ("deg", "degree", "degrees", "°", "rad", "radian", "radians")


def angle(name: str, words: str) -> Argument:
    """Return an argument that is an angle above zero and below half a turn [rad]."""

    def read(table: TableReader, key: str, process: Process) -> float:
        remedy = 'write as in "60 deg"'
        parts = split_quantity(table.raw(key))
        # Any share would be taken for radians: 60 % of them are 34 deg.
        if parts is None or parts[1] not in _ANGLES:
            raise table.refused(key, table.written(key), "an angle in deg or rad", remedy)
        degrees = table.quantity(key, "deg", "an angle", remedy, above=0.0)
        if not degrees < 180.0:
            raise table.refused(key, table.written(key), "an angle below 180 deg", remedy)
        return math.radians(degrees)

    return argument(name, read, words, {"type": "string"}, "quantity")


def angular_frequency(name: str, words: str) -> Argument:
    """Return an argument that is an angular frequency above zero [rad/s]."""

    def read(table: TableReader, key: str, process: Process) -> float:
        remedy = 'write as in "0.01 rad/s"'
        parts = split_quantity(table.raw(key))
        # Units of an angle are numbers, so that a hertz would be taken for one radian a second.
        if parts is not None and re.search("hz|hertz", parts[1], re.IGNORECASE):
            raise table.refused(
                key,
                table.written(key),
                "an angular frequency in rad/s",
                "multiply hertz by 2 pi, which is 6.283",
            )
        return table.quantity(key, "rad/s", "a frequency", remedy, above=0.0)

    return argument(name, read, f"{words} [rad/s], above 0", {"type": "string"}, "quantity")
