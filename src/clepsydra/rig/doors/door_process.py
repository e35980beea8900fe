"""The process in which a door of a rig serves."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import Path

from clepsydra.rig.doors.door import Door
from clepsydra.rig.image import ImageLayout, ProcessImage
from clepsydra.rig.report import Reporter
from clepsydra.rig.tag import Tag
from clepsydra.rig.tag_table import TagTable


def serve_door(
    reporter: Reporter, door: Door, tags: Sequence[Tag], image: Path, layout: ImageLayout
) -> None:
    """Serve until the process is ended."""
    table = TagTable(tags, ProcessImage(image, layout))
    asyncio.run(door.serve(table, reporter))
