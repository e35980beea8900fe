"""What a rig says of itself on a terminal: where it is found, and how it stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text
from clepsydra.rig.tag import HEARD, LATENESS, REMOTE, Tag
from clepsydra.rig.tag_table import WRITES

if TYPE_CHECKING:
    from clepsydra.rig.running import RunningRig

#: So many measurements stand in the line of a rig.
_SHOWN = 4


def opening(rig: RunningRig) -> list[str]:
    """Return the lines with which it begins."""
    settings = rig.settings
    period = settings.process.sampling_period
    pace = "in real time" if settings.speed == 1.0 else f"{settings.speed:g} times as fast as it is"
    folder = settings.folder / "history.sqlite"
    found = [(door.title, door.address) for door in settings.doors] + [("History", str(folder))]
    width = max(len(title) for title, _ in found)
    lines = [f"{settings.title} runs {pace}, a sample each {time_text(period / settings.speed)}."]
    lines += [f"  {title:{width}}  {address}" for title, address in found]
    return [*lines, "Control-C ends it; --resume goes on from there."]


def standing(rig: RunningRig) -> str:
    """Return how it stands, in a line."""
    who = _mover(rig)
    tags = [tag for tag in rig.settings.tags if tag.judged_by][:_SHOWN]
    shown = "  ".join(_shown(rig, tag) for tag in tags)
    late = 1000.0 * rig.image.read(LATENESS)
    return f"{time_text(rig.elapsed, 6)}  {shown}  {who}  {late:.1f} ms late"


def _mover(rig: RunningRig) -> str:
    image = rig.image
    if not image.read(REMOTE):
        return "local"
    if not image.read(WRITES):
        return "waits for a controller"
    return "remote" if image.read(HEARD) else "controller silent: fail-safe"


def _shown(rig: RunningRig, tag: Tag) -> str:
    reading = rig.table.read(tag)
    unit = unit_text(tag.signal.unit)
    return f"{tag.label} {reading.value:.4g} {unit}{'' if reading.good else ' bad'}"
