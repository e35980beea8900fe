"""The shape of a tank, read from its table of a process file."""

from __future__ import annotations

import math
from typing import Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.process import told
from clepsydra.process.declared import table_schema
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.cone import Cone
from clepsydra.process.vessels.horizontal_cylinder import HorizontalCylinder
from clepsydra.process.vessels.prism import Prism
from clepsydra.process.vessels.sphere_segment import SphereSegment
from clepsydra.process.vessels.table import AreaTable
from clepsydra.process.vessels.vessel import Vessel

#: The first is meant where a file names no shape.
SHAPES: tuple[type[Vessel], ...] = (Prism, HorizontalCylinder, Cone, SphereSegment, AreaTable)
#: The keys of a tank that describe its shape.
VESSEL_KEYS: dict[str, Any] = {
    "shape": told.choice("its shape; prism if left out", [vessel.shape for vessel in SHAPES])
}
for _vessel in SHAPES:
    for _key, _schema in table_schema(_vessel)["properties"].items():
        VESSEL_KEYS.setdefault(_key, _schema)
_LARGEST_CAPACITY = 1e15
_SMALLEST_CAPACITY = 1e-15


def read_vessel(table: TableReader) -> Vessel:
    """Make the vessel that the table of a tank describes.

    Parameters
    ----------
    table : TableReader
        May have other keys than those of `VESSEL_KEYS`, which are left alone.
    """
    names = [vessel.shape for vessel in SHAPES]
    name = table.choice("shape", names, Prism.shape)
    vessel = SHAPES[names.index(name)]
    for key in table.present:
        if key in VESSEL_KEYS and key != "shape" and key not in vessel.keys:
            expected = f"one of {', '.join(vessel.keys)} for the shape {name}"
            remedy = "remove it, or choose the shape that it belongs to"
            raise table.refused(key, key, expected, remedy)
    made = vessel.read(table)
    _check_capacity(made, table)
    return made


def vessel_checks() -> list[dict[str, Any]]:
    """Return what a JSON Schema requires of each shape, by its name."""
    found = []
    for vessel in SHAPES:
        schema = table_schema(vessel)
        named: dict[str, Any] = {"properties": {"shape": {"const": vessel.shape}}}
        if vessel is not SHAPES[0]:
            named["required"] = ["shape"]
        wanted = {key: schema[key] for key in ("required", "allOf") if key in schema}
        found.append({"if": named, "then": wanted})
    return found


def _check_capacity(vessel: Vessel, table: TableReader) -> None:
    """Refuse sizes, such as 1e-200 m, whose powers are not numbers any more."""
    try:
        capacity = vessel.capacity
    except (OverflowError, ZeroDivisionError):
        capacity = math.nan
    if not _SMALLEST_CAPACITY <= capacity <= _LARGEST_CAPACITY:
        expected = f"a capacity from {_SMALLEST_CAPACITY:g} m^3 to {_LARGEST_CAPACITY:g} m^3"
        remedy = "check the units of the sizes"
        raise InputError(table.place(), Finding("sizes of no tank"), expected, remedy)
