"""A vessel of any shape, given by its area at some levels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar

import casadi as ca

from clepsydra.process import told
from clepsydra.process.declared import filled, part
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.vessel import SMALLEST_SHARE, Vessel


@dataclass(frozen=True)
class AreaTable(Vessel):
    """A vessel whose area is linear between the levels of a table.

    Within a segment whose narrow end has area A and whose area grows by s a metre from there,
    the volume to a distance z is dV = A z + s z²/2. The way back is the root of this quadratic
    in the form that cancels nothing, z = 2 dV / (A + √(A² + 2 s dV)).

    Parameters
    ----------
    levels : tuple of float
        From 0, strictly increasing; the last is the rim [m].
    areas : tuple of float
        Above zero, the first at least zero [m²].

    Examples
    --------
    >>> table = AreaTable(levels=(0.0, 0.5, 1.0), areas=(1.0, 2.0, 2.0))
    >>> table.capacity, float(table.level(0.75, table.values()))
    (1.75, 0.5)
    """

    shape: ClassVar[str] = "table"

    levels: tuple[float, ...] = part(
        lambda table, key, known: _read_rows(table),
        {
            "table": told.pairs(
                "list of pairs of level [m] and area [m^2], from the floor up", "m", "m^2"
            )
        },
        fills=True,
        required=("table",),
    )
    areas: tuple[float, ...] = filled()
    height: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "height", self.levels[-1])

    @property
    def _segments(self) -> list[dict[str, float]]:
        """The parts between two levels, each measured from its narrow end.

        At a distance z from there, A = area + growth · z; `upward` is 1 where the narrow end is
        the lower one and -1 where it is the upper one. `from_level` and `from_volume` are those
        of the lower end, at which the segment begins to hold.
        """
        segments = []
        volume = 0.0
        rows = zip(self.levels, self.areas, strict=True)
        for (low, low_area), (high, high_area) in pairwise(rows):
            full = volume + 0.5 * (low_area + high_area) * (high - low)
            widens = low_area <= high_area
            segments.append(
                {
                    "from_level": low,
                    "from_volume": volume,
                    "level": low if widens else high,
                    "volume": volume if widens else full,
                    "area": min(low_area, high_area),
                    "growth": abs(high_area - low_area) / (high - low),
                    "upward": 1.0 if widens else -1.0,
                }
            )
            volume = full
        return segments

    def _chosen(self, quantity: str, value: ca.SX) -> dict[str, ca.SX]:
        """Return the numbers of the segment in which a level or volume lies."""
        first, *others = self._segments
        chosen: dict[str, Any] = {**first}
        for segment in others:
            reached = value >= segment[quantity]
            for name, number in segment.items():
                chosen[name] = ca.if_else(reached, number, chosen[name])
        return chosen

    def _area_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        segment = self._chosen("from_level", level)
        distance = segment["upward"] * (level - segment["level"])
        return segment["area"] + segment["growth"] * distance

    def _volume_within(self, level: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        segment = self._chosen("from_level", level)
        distance = segment["upward"] * (level - segment["level"])
        content = distance * (segment["area"] + 0.5 * segment["growth"] * distance)
        return segment["volume"] + segment["upward"] * content

    def _level_within(self, volume: ca.SX, values: Mapping[str, ca.SX]) -> ca.SX:
        segment = self._chosen("from_volume", volume)
        content = segment["upward"] * (volume - segment["volume"])
        content = ca.fmax(content, SMALLEST_SHARE * self.levels[-1] * max(self.areas))
        area = ca.sqrt(segment["area"] ** 2 + 2 * segment["growth"] * content)
        return segment["level"] + segment["upward"] * (2 * content / (segment["area"] + area))


def _shown(value: float, unit: str) -> str:
    return f"{value:g} {unit}"


def _read_rows(table: TableReader) -> dict[str, tuple[float, ...]]:
    """Return the levels [m] and the areas [m²] of the rows."""
    remedy = 'write as in table = [["0 m", "1 m^2"], ["0.5 m", "2 m^2"]]'
    rows = table.pairs("table", "m", "m^2", "a list of pairs of level and area", remedy)
    if len(rows) < 2:
        raise table.wrong("table", "at least two rows", remedy)
    levels, areas = tuple(row[0] for row in rows), tuple(row[1] for row in rows)
    if levels[0] != 0.0:
        expected = "a first level of 0 m, the floor"
        remedy = "measure the levels from the floor, and give the area there"
        raise table.refused("table", _shown(levels[0], "m"), expected, remedy)
    for lower, upper in pairwise(levels):
        if not lower < upper:
            expected = f"a level above {_shown(lower, 'm')}, the one before it"
            remedy = "sort the rows by their level, and give every level once"
            raise table.refused("table", _shown(upper, "m"), expected, remedy)
    if areas[0] < 0.0:
        raise table.refused(
            "table", _shown(areas[0], "m^2"), "an area of at least 0 m^2", "correct the area"
        )
    for level, area in rows[1:]:
        if area <= 0.0:
            expected = f"an area above 0 m^2 at {_shown(level, 'm')}"
            raise table.refused("table", _shown(area, "m^2"), expected, "correct the area")
    return {"levels": levels, "areas": areas}
