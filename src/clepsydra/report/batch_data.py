"""The scores of a batch as data: over events and draws, with units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.scores.segment import Segment
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.drawn_scores import DrawnScores

if TYPE_CHECKING:
    import xarray


def event_label(segment: Segment | None, place: int) -> str:
    """Return what happens in a stretch, with its time, as a label that no other has.

    Examples
    --------
    >>> event_label(Segment("setpoint", "level_1", 60.0, 660.0, 1.0), 1)
    'setpoint level_1 at 60 s'
    """
    if segment is None:
        return f"between events, stretch {place}"
    return " ".join(filter(None, (segment.kind, segment.signal, f"at {time_text(segment.start)}")))


def dataset_of(loops: DrawnLoops, drawn: DrawnScores) -> xarray.Dataset:
    """Return scores over events and draws, and what varies over draws."""
    import xarray

    process = loops.plants.point.process
    values = loops.plants.values(drawn.numbers)
    events = ["whole run", *(event_label(each, k) for k, each in enumerate(loops.events))]
    units = loops.units
    variables: dict[str, Any] = {
        name: (("event", "draw"), rows, {"units": units[name]})
        for name, rows in drawn.scores.items()
    }
    for name, column in values.items():
        signal = process.signal(name)
        about = {"units": signal.unit, "long_name": signal.description or name}
        variables[name] = ("draw", column, about)
    for what, truths in drawn.happened.items():
        variables[what.name.lower()] = ("draw", truths, {"long_name": str(what)})
    reasons = np.array([*drawn.reasons, ""], dtype=object)
    variables["reason"] = ("draw", reasons[drawn.reason].astype(str))
    coordinates = {"draw": drawn.numbers, "event": events}
    about = {"process": process.name, "controller": loops.controller.name}
    return xarray.Dataset(variables, coords=coordinates, attrs=about)
