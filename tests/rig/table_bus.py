"""A bus without wires: the tags of a rig on the same machine, straight from its image."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from clepsydra.rig.bus import BusFault
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import Refused, TagTable

_NAME = "process image"


@dataclass
class TableBus:
    """The tags of a rig as a bus, with nothing lost and nothing rounded on the way.

    Parameters
    ----------
    image : Path
    layout : ImageLayout
    tags : tuple of Tag
    """

    image: Path
    layout: ImageLayout
    tags: tuple[Tag, ...]
    _table: TagTable | None = field(default=None, init=False, repr=False)

    async def open(self) -> None:
        """Map the image into memory.

        Raises
        ------
        BusFault
            There is no image, or that of another plant.
        """
        try:
            self._table = TagTable(self.tags, ProcessImage(self.image, self.layout))
        except (OSError, ValueError) as error:
            raise BusFault(_NAME, "", str(error), answered=False) from None

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of tags, in the units of their signals."""
        table = self._open()
        return {name: table.read(self._tag(table, name)).value for name in names}

    async def write(self, values: Mapping[str, float]) -> None:
        """Give tags values, in the units of their signals.

        Raises
        ------
        BusFault
            The rig does not take one of them; those before it are taken.
        """
        table = self._open()
        for name, value in values.items():
            try:
                table.write(self._tag(table, name), value)
            except Refused as refusal:
                raise BusFault(_NAME, name, str(refusal), answered=True) from None

    async def close(self) -> None:
        """Leave."""
        self._table = None

    def _open(self) -> TagTable:
        if self._table is None:
            raise BusFault(_NAME, "", "it is not open", answered=False)
        return self._table

    def _tag(self, table: TagTable, name: str) -> Tag:
        if name not in table.tags:
            raise BusFault(_NAME, name, "the rig has no such tag", answered=True)
        return table.tags[name]
