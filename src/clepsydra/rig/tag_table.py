"""The tags of a rig as its doors read and write them: every value checked, in one place."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from clepsydra.rig.image import ProcessImage
from clepsydra.rig.tag import Tag, Writer

#: Counts what controllers have written, whatever it was: their silence is seen by it.
WRITES = "controller.writes"


class Refusal(Enum):
    """Why a value is not taken."""

    NOT_WRITABLE = "the plant writes it"
    NO_NUMBER = "it is not a finite number"
    NO_WHOLE_NUMBER = "it is not a whole number"
    OUT_OF_RANGE = "it is outside of what the wires take"


class Refused(Exception):
    """A value that is not taken.

    Parameters
    ----------
    tag : Tag
    value : float
    why : Refusal
    """

    def __init__(self, tag: Tag, value: float, why: Refusal) -> None:
        super().__init__(f"{tag.label} := {value:g}: {why.value}")
        self.tag, self.value, self.why = tag, value, why


@dataclass(frozen=True)
class Reading:
    """What a tag shows.

    Parameters
    ----------
    value : float
        In the unit of the tag's signal.
    good : bool
        Whether its sensor says that it can be believed.
    time : float
        [s since 1970]
    """

    value: float
    good: bool
    time: float


class TagTable:
    """Tags and the process image behind them.

    Parameters
    ----------
    tags : iterable of Tag
    image : ProcessImage
    """

    def __init__(self, tags: Iterable[Tag], image: ProcessImage) -> None:
        self.tags = {tag.name: tag for tag in tags}
        self.image = image

    def read(self, tag: Tag) -> Reading:
        """Return what a tag shows now."""
        image = self.image
        judge = self.tags.get(tag.judged_by)
        good = judge is None or image.read(judge.cell) != 0.0
        return Reading(tag.on_wire(image.read(tag.cell)), good, image.published().time)

    @staticmethod
    def check(tag: Tag, value: float) -> None:
        """Refuse a value that a tag does not take, in the unit of its signal.

        Raises
        ------
        Refused
        """
        if tag.writer is Writer.PLANT:
            raise Refused(tag, value, Refusal.NOT_WRITABLE)
        if not math.isfinite(value):
            raise Refused(tag, value, Refusal.NO_NUMBER)
        if tag.signal.kind != "real" and value != math.floor(value):
            raise Refused(tag, value, Refusal.NO_WHOLE_NUMBER)
        if not tag.lowest <= value <= tag.highest:
            raise Refused(tag, value, Refusal.OUT_OF_RANGE)

    def write(self, tag: Tag, value: float) -> None:
        """Give a tag a value, in the unit of its signal.

        Raises
        ------
        Refused
            The plant writes it, or it is no number that the wires take.
        """
        self.check(tag, value)
        image = self.image
        image.write(tag.cell, tag.in_cell(value))
        if tag.writer is Writer.CONTROLLER:
            # Two controllers that count at once lose a count, and no silence is seen in it.
            image.write(WRITES, image.read(WRITES) + 1.0)
