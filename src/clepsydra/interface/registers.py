"""`cl.registers`: the register map of a process for masters of Modbus."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.keywords import keywords_checked
from clepsydra.interface.rig_doors import INSTALLED, Doors
from clepsydra.interface.shown import Answered
from clepsydra.interface.subject import Subject, plant_of

if TYPE_CHECKING:
    from clepsydra.base.section import Section
    from clepsydra.rig.doors.modbus.register_map import RegisterMap

#: What a terminal shows of a row; the file has more.
_SHOWN = ("reference", "tag", "encoding", "unit", "low", "high", "written by")


class Registers(Answered):
    """Where each tag of a process stands in the tables of Modbus.

    Parameters
    ----------
    title : str
        Of the process.
    register_map : RegisterMap
    """

    def __init__(self, title: str, register_map: RegisterMap) -> None:
        self.title, self.register_map = title, register_map

    def answer(self, *, every: bool = False) -> Section:
        """Return the map as a table."""
        from clepsydra.base.section import Line, Section, Table

        rows = tuple(tuple(row[name] for name in _SHOWN) for row in self.register_map.rows())
        words = "References count from 1; the address of a request is the number behind, less 1."
        return Section(f"Registers of {self.title}", (Table("", _SHOWN, rows, 3), Line(words)))

    def as_dict(self) -> dict[str, object]:
        """Return the map as values for JSON, an entry a row."""
        return {"registers": self.register_map.rows()}

    def write(self, path: str | Path) -> None:
        """Write the map as CSV, which a rig reads again."""
        from clepsydra.rig.doors.modbus.map_file import write_map

        write_map(self.register_map, Path(path))


@keywords_checked()
def registers(plant: Subject, doors: Doors = INSTALLED) -> Registers:
    """Return the register map of a process.

    Parameters
    ----------
    plant : Plant, str or Path
    doors : Doors
        Whose map it is: of its file, or with its encoding.

    Raises
    ------
    InputError
        The file of the map cannot be used, or there is no such encoding.

    Examples
    --------
    >>> found = registers("quadruple-tank", Doors(encoding="counts-27648"))
    >>> found.register_map.by_tag["level_1.pv"].reference
    '30001'
    """
    from clepsydra.rig.tags import tags_of

    own = plant_of(plant)
    return Registers(own.process.title, doors.register_map(tags_of(own.point)))
