"""Tags of a rig at one moment: what the plant has told is of one sample."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import TagTable


class Snapshot(NamedTuple):
    """What tags show at one moment.

    Parameters
    ----------
    sample : int
        Of the plant; −1 before it has told anything.
    value : callable
        Takes a tag and returns what it shows, in the unit of its signal.
    """

    sample: int
    value: Callable[[Tag], float]


class Snapshots:
    """Takes snapshots of a table of tags.

    Parameters
    ----------
    table : TagTable
    """

    def __init__(self, table: TagTable) -> None:
        self._image = table.image
        layout = table.image.layout
        # As in `ProcessImage.read`, what is told comes before what is written under its name.
        self._told = {name: place for place, name in enumerate(layout.published)}
        self._written = {name: place for place, name in enumerate(layout.written)}

    def take(self) -> Snapshot:
        """Return what all tags show now."""
        told, written = self._image.published(), self._image.written()

        def value(tag: Tag) -> float:
            place = self._told.get(tag.cell)
            cell = written[self._written[tag.cell]] if place is None else told.values[place]
            return tag.on_wire(float(cell))

        return Snapshot(told.sample, value)
