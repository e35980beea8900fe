"""The page of a running rig as HTML: the laboratory's, with the plant elsewhere."""

from __future__ import annotations

from typing import Any

from clepsydra.base.errors import Finding, InputError
from clepsydra.engine.trajectories import rings_and_turns
from clepsydra.laboratory.page_data import plant_data, seen_controller
from clepsydra.laboratory.rig import Rig
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.html import json_text
from clepsydra.report.live.modules import Modules
from clepsydra.report.page import lab_assets, rendered
from clepsydra.rig.plant import PlantSettings

#: A delay of the process has a ring of starts, one of means and one of ends.
_RINGS = 3


def attached_text(rig: Rig, settings: PlantSettings, *, speed: float) -> str:
    """Return the page of a running rig as HTML.

    Parameters
    ----------
    rig : Rig
        Of the laboratory.
    settings : PlantSettings
        Those of its plant.
    speed : float
        Times as fast as real time.

    Raises
    ------
    InputError
        The script of the page was not built.
    """
    assets = lab_assets()
    if assets is None:
        raise InputError(
            "page", Finding("no script of its page"), "an installation with it",
            "install Clepsydra once more with a network, or from a wheel; or leave the page out",
        )  # fmt: skip
    station = settings.station
    drawing = process_drawing(rig.point.process, rig.point, station.controller, alive="rig-0")
    return rendered(
        "lab.html.jinja",
        title=f"{rig.process.title} – running rig",
        name=rig.process.title,
        lesson=None,
        alarms=rig.process.alarms,
        drawings=[drawing],
        attached=True,
        data=json_text(attached_data(rig, settings, speed=speed)),
        assets=assets,
    )


def attached_data(rig: Rig, settings: PlantSettings, *, speed: float) -> dict[str, Any]:
    """Return all that the page of a running rig needs beside its drawing.

    Parameters
    ----------
    rig : Rig
    settings : PlantSettings
    speed : float
    """
    modules = Modules()
    return {
        **plant_data(rig, modules),
        # Nobody drills or fills what stands elsewhere.
        "tanks": [],
        "controllers": [{**seen_controller(settings.station), "drawing": 0}],
        "attached": {"plant": settings.layout.plant, "speed": speed},
        "modules": modules.held,
    }


def delay_places(settings: PlantSettings) -> tuple[int, ...]:
    """Return, of what the plant remembers, the places of what comes out of its delays.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.assembly import plant_settings
    >>> plant = cl.load("quadruple-tank")
    >>> bench = Rig(plant.linear, [cl.design.simc(plant)])
    >>> delay_places(plant_settings(bench, speed=1.0, fail_safe={}))
    ()
    """
    station = settings.station
    rings = [ring for ring, _ in rings_and_turns(station.program)]
    own = set(station.process_rings)
    # Behind states and rings stands what each sensor has drifted by.
    held = sum(ring.length for ring in rings)
    place = settings.layout.remembered - len(station.loop.process.measurements) - held
    found = []
    for ring in rings:
        if ring.name in own:
            found.append(place)
        place += ring.length
    return tuple(found[::_RINGS])
