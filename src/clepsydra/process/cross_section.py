"""A cross-section as a file gives it: an area, or the diameter of a circle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING
from typing import Any

from clepsydra.base.quantity import Quantity
from clepsydra.process.declared import part
from clepsydra.process.table_reader import TableReader

#: The keys of a file that give it, one in place of the other.
KEYS = ("area", "diameter")


def cross_section(of: str, area_remedy: str, diameter_remedy: str, *, strict: bool) -> Any:
    """Return the field of an area [m²] that a file gives by exactly one of two keys.

    Parameters
    ----------
    of : str
        What has it, for editors: "tank".
    area_remedy, diameter_remedy : str
        What to give.
    strict : bool
        It must be above zero.

    Examples
    --------
    >>> from clepsydra.process.elements.orifice import Orifice
    >>> from clepsydra.process.document import parse
    >>> text = b"source = 'tank_1'\\ndestination = 'basin'\\ndiameter = '2 cm'"
    >>> table = TableReader(parse(text, "plant.toml"), (), Orifice.keys)
    >>> round(Orifice.read("outlet_1", table).area * 1e4, 4)  # [cm²]
    3.1416
    """
    size: Any = {"low": 0.0, "strict": strict}
    area = Quantity("area", "m^2", expected="an area", remedy=area_remedy, **size)
    diameter = Quantity("diameter", "m", expected="a diameter", remedy=diameter_remedy, **size)

    def read(table: TableReader, key: str, known: Mapping[str, Any]) -> float:
        if table.has("area") and table.has("diameter"):
            table.refuse(("diameter",), "either an area or a diameter", "remove one of the two")
        if not table.has("diameter"):
            return float(table.declared(area, {}, MISSING))
        return math.pi / 4 * float(table.declared(diameter, {}, MISSING)) ** 2

    return part(
        read,
        {
            "area": area.schema(words=f"cross-section of the {of}"),
            "diameter": diameter.schema(words=f"inner diameter of the {of}, in place of its area"),
        },
        checks=({"oneOf": [{"required": [key]} for key in KEYS]},),
    )
