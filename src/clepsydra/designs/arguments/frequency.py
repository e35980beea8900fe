"""Arguments that are angles or angular frequencies, whose units are numbers to a computer."""

from __future__ import annotations

import math
import re
from dataclasses import MISSING
from typing import TYPE_CHECKING, Any

from clepsydra.base.arguments import is_finite_number
from clepsydra.base.errors import InputError
from clepsydra.base.quantity import Quantity
from clepsydra.base.units import split_quantity
from clepsydra.designs.arguments.argument import Argument, argument

if TYPE_CHECKING:
    from clepsydra.process.process import Process
    from clepsydra.process.table_reader import TableReader

_ANGLES = ("deg", "degree", "degrees", "°", "rad", "radian", "radians")


def angle(name: str, words: str) -> Argument:
    """Return an argument that is an angle above zero and below half a turn [rad]."""

    def check(value: Any) -> None:
        if not is_finite_number(value) or not 0.0 < value < math.pi:
            remedy = "give it in radians, as math.radians(60)"
            raise InputError(name, value, "an angle between 0 and π rad", remedy)

    def read(table: TableReader, key: str, process: Process) -> float:
        remedy = 'write as in "60 deg"'
        parts = split_quantity(table.raw(key))
        # Any share would be taken for radians: 60 % of them are 34 deg.
        if parts is None or parts[1] not in _ANGLES:
            raise table.wrong(key, "an angle in deg or rad", remedy)
        degrees = table.quantity(key, "deg", "an angle", remedy, above=0.0)
        if not degrees < 180.0:
            raise table.wrong(key, "an angle below 180 deg", remedy)
        return math.radians(degrees)

    return argument(name, read, words, {"type": "string"}, "quantity", check)


def angular_frequency(name: str, words: str) -> Argument:
    """Return an argument that is an angular frequency above zero [rad/s]."""
    remedy = 'write as in "0.01 rad/s"'
    declared = Quantity(name, "rad/s", low=0.0, strict=True, expected="a frequency", remedy=remedy)

    def read(table: TableReader, key: str, process: Process) -> float:
        parts = split_quantity(table.raw(key))
        # Units of an angle are numbers, so that a hertz would be taken for one radian a second.
        if parts is not None and re.search("hz|hertz", parts[1], re.IGNORECASE):
            raise table.wrong(
                key, "an angular frequency in rad/s", "multiply hertz by 2 pi, which is 6.283"
            )
        return float(table.declared(declared, {}, MISSING))

    return argument(
        name, read, f"{words} [rad/s], above 0", {"type": "string"}, "quantity", declared.check
    )
