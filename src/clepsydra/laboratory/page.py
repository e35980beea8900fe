"""The page of a laboratory: one file that moves a process, without a network."""

from __future__ import annotations

from clepsydra.base.errors import InputError
from clepsydra.laboratory.page_data import page_data
from clepsydra.laboratory.rig import Rig
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.html import json_text
from clepsydra.report.page import lab_assets, rendered


def lab_text(rig: Rig) -> str:
    """Return the page of a rig as HTML.

    Raises
    ------
    InputError
        The script of the page was not built.
    """
    assets = lab_assets()
    if assets is None:
        raise InputError(
            "lab", "no script of its page", "an installation with it",
            "install Clepsydra once more with a network, or from a wheel",
        )  # fmt: skip
    drawings = [
        process_drawing(rig.process, station.loop.point, station.controller, alive=f"rig-{place}")
        for place, station in enumerate(rig.stations)
    ]
    return rendered(
        "lab.html.jinja",
        title=f"{rig.process.title} – laboratory",
        name=rig.process.title,
        drawings=drawings,
        data=json_text(page_data(rig)),
        assets=assets,
    )
