"""A run as the script of a report reads it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from clepsydra.base.words import time_unit
from clepsydra.loop.run import Run
from clepsydra.report.colours import INK, signal_colours
from clepsydra.report.panel_content import panel_content
from clepsydra.report.panels import Panel
from clepsydra.report.recording import recording_of

#: More than a picture can show, and a fifth of the characters.
_DIGITS = 5


def trend_data(run: Run, panels: Sequence[Panel]) -> dict[str, Any]:
    """Return the panels of a run with a value for each sample: `Trends` of page/sources/data.ts.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.panels import controlled_panels
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> data = trend_data(run, controlled_panels(run))
    >>> data["unit"], [curve["name"] for curve in data["panels"][0]["curves"]]
    ('s', ['setpoint of level_1', 'tank_1.level'])
    """
    recording = recording_of(run)
    unit, seconds = time_unit(recording.end - float(recording.time[0]))
    time = recording.time / seconds
    colours = signal_colours(run.process)
    shown = []
    for panel in panels:
        content = panel_content(panel, recording, time, colours.get(panel.signal.name, INK))
        curves = [
            {
                "name": curve.name,
                "colour": curve.colour,
                "dashed": curve.dashed,
                "values": _short(curve.values),
            }
            for curve in content.curves
            if len(curve.time) == len(time)
        ]
        shown.append({"unit": content.unit, "curves": curves})
    return {"unit": unit, "time": _short(time), "panels": shown}


def _short(values: Any) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in values]
