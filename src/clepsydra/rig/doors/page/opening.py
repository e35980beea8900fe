"""The door of the page of a rig, with the page that it serves."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from clepsydra.base.files import make_folder
from clepsydra.laboratory.rig import Rig
from clepsydra.report.page import write_page
from clepsydra.rig.doors.page.cells import cells_of
from clepsydra.rig.doors.page.document import attached_text, delay_places
from clepsydra.rig.doors.page.door import DEFAULT_PORT, PageDoor, token_for
from clepsydra.rig.plant import PlantSettings
from clepsydra.rig.tag import Tag

#: In the folder of the rig.
PAGE = "page.html"


def page_door(
    rig: Rig,
    settings: PlantSettings,
    tags: Iterable[Tag],
    folder: Path,
    *,
    speed: float = 1.0,
    host: str = "127.0.0.1",
    port: int = DEFAULT_PORT,
    view_only: bool = False,
) -> PageDoor:
    """Write the page of a rig into its folder, and return the door that serves it.

    Where others than this machine reach it, it has a new token.

    Parameters
    ----------
    rig : Rig
        Of the laboratory, as `plant_settings` got it.
    settings : PlantSettings
    tags : iterable of Tag
    folder : Path
        Made where it is missing.
    speed : float
        Times as fast as real time.
    host : str
        The address of this machine at which it listens.
    port : int
    view_only : bool
        Whether pages only look on.

    Raises
    ------
    InputError
        The folder cannot be written to, or the script of the page was not built.
    """
    make_folder(folder, "rig, folder")
    page = folder / PAGE
    write_page(attached_text(rig, settings, speed=speed), page)
    return PageDoor(
        page=page, plant=settings.layout.plant, cells=cells_of(rig.point.process, tags),
        delays=delay_places(settings), host=host, port=port, token=token_for(host),
        view_only=view_only,
    )  # fmt: skip
