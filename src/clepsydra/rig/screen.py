"""What a rig says of itself on a terminal: where it is found, and how it stands."""

from __future__ import annotations

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.retention import KEEP_ALL
from clepsydra.rig.settings import HISTORY, RigSettings
from clepsydra.rig.tag import HEARD, LATENESS, REMOTE, Tag
from clepsydra.rig.tag_table import WRITES, TagTable

#: So many measurements stand in the line of a rig.
_SHOWN = 4


def opening(settings: RigSettings) -> list[str]:
    """Return the lines with which a rig begins."""
    period = settings.process.sampling_period
    pace = "in real time" if settings.speed == 1.0 else f"at {settings.speed:g} times real time"
    found = [(door.title, door.address, door.note) for door in settings.doors]
    found.append(("History", str(settings.folder / HISTORY), ""))
    width = max(len(title) for title, _, _ in found)
    lines = [f"{settings.title} runs {pace}, a sample every {time_text(period / settings.speed)}."]
    lines += [
        f"  {title:{width}}  {address}{f' ({note})' if note else ''}"
        for title, address, note in found
    ]
    return [*lines, "Control-C ends it."]


def ending(settings: RigSettings, elapsed: float, waiting: int) -> str:
    """Return the line with which a rig ends, after some time [s].

    Parameters
    ----------
    waiting : int
        Samples that the history could not take.
    """
    path = settings.folder / HISTORY
    if waiting:
        return (
            f"Ended after {time_text(elapsed, 6)}. {path} could not be written: {waiting} samples "
            "wait beside it; make room on the disk, and --resume keeps them and goes on."
        )
    kept = "has every sample" if settings.retention == KEEP_ALL else "has what was to be kept"
    return f"Ended after {time_text(elapsed, 6)}. {path} {kept}; --resume goes on from there."


def standing(table: TagTable, elapsed: float) -> str:
    """Return how a rig stands after some time [s], in a line."""
    tags = [tag for tag in table.tags.values() if tag.judged_by][:_SHOWN]
    shown = "  ".join(_shown(table, tag) for tag in tags)
    late = 1000.0 * table.image.read(LATENESS)
    return f"{time_text(elapsed, 6)}  {shown}  {_mover(table.image)}  {late:.1f} ms late"


def _mover(image: ProcessImage) -> str:
    if not image.read(REMOTE):
        return "local"
    if not image.read(WRITES):
        return "waits for a controller"
    return "remote" if image.read(HEARD) else "controller silent: fail-safe"


def _shown(table: TagTable, tag: Tag) -> str:
    reading = table.read(tag)
    unit = unit_text(tag.signal.unit)
    return f"{tag.label} {reading.value:.4g} {unit}{'' if reading.good else ' bad'}"
