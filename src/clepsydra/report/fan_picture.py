"""Between which values many plants are, event by event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.process.process import Process
from clepsydra.report.colours import MUTED, PALETTE
from clepsydra.report.overlay import event_title
from clepsydra.report.plant_axes import (
    HELD,
    MEASURED,
    MOVED,
    PAPER,
    SETPOINT,
    name_lines,
    set_ends,
)
from clepsydra.report.quantities import display_factor, fitted
from clepsydra.report.response_axes import picture
from clepsydra.scores.segment import Segment
from clepsydra.studies.robustness.drawn_loops import DrawnLoops
from clepsydra.studies.robustness.fan import CHANCES, Fan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Events side by side, and points of a curve in each, at most.
_COLUMNS, _POINTS = 4, 200
#: Plants are at rest where they are within this share of what they move; so much longer is shown,
#: and so much before the event.
_SETTLED, _AFTER, _BEFORE = 0.03, 1.2, 0.06
#: Letters of a title that one inch has room for.
_LETTERS, _WIDTH = 14, 6.6
#: Of the name of a row, by its height.
_TALL, _LOW = 20, 14


@dataclass(frozen=True, eq=False)
class FanWindow:
    """A stretch of a scenario that has a column of its own.

    Parameters
    ----------
    title : str
    records : ndarray of int [points]
        Of the fan, rising.
    start : float
        What its time counts from [s].
    """

    title: str
    records: np.ndarray
    start: float


def fan_windows(loops: DrawnLoops, fan: Fan) -> list[FanWindow]:
    """Return the first event of each signal, as long as the plants need to settle; four at most.

    A scenario without events is one window.
    """
    process, seen = loops.plants.point.process, set()
    found = []
    for segment in loops.scenario.segments:
        if segment.kind == "noise" or (segment.kind, segment.signal) in seen:
            continue
        seen.add((segment.kind, segment.signal))
        records = _records(process, fan, segment)
        found.append(FanWindow(event_title(process, segment), records, segment.start))
    whole = FanWindow("", _thinned(0, len(fan.time)), 0.0)
    return found[:_COLUMNS] or [whole]


def fan_figure(loops: DrawnLoops, fan: Fan) -> Figure:
    """Draw between which values the plants are: each measurement and moved input, by events.

    Bands hold 90 % and half of the plants, at each instant by itself.

    Parameters
    ----------
    fan : Fan
        Of these loops.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot: it belongs to nobody but the caller.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.studies.robustness.fan import fan_of
    >>> plant = cl.load("three-tanks")
    >>> found = cl.robustness(cl.design.simc(plant), plant, draws=20, sensitivity=False)
    >>> figure = fan_figure(found.loops, fan_of(found.loops, 20))
    >>> figure.axes[0].get_title(loc="left"), figure.axes[0].get_ylabel()
    ('Setpoint level_3\\n+1 cm', 'level_3\\n[cm]')
    """
    process = loops.plants.point.process
    names = (*process.controlled, *loops.controller.manipulated)
    windows = fan_windows(loops, fan)
    heights = [MEASURED if name in process.controlled else MOVED for name in names]
    size = len(names), len(windows), sum(heights) / len(heights)
    share = {"height_ratios": heights}
    with picture(*size, sharex="col", gridspec_kw=share) as (figure, grid):
        for row, name in zip(grid, names, strict=True):
            for axes, window in zip(row, windows, strict=True):
                _draw(axes, loops, fan, window, name)
            signal = process.signal(name)
            set_ends(row.tolist(), signal)
            for axes in row:
                axes.axvline(0.0, color=MUTED, linewidth=0.5, alpha=0.6)
            room = _TALL if name in process.controlled else _LOW
            unit = unit_text(signal.shown_unit) or "1"
            row[0].set_ylabel(f"{fitted(name, room)}\n[{unit}]")
        letters = int(_LETTERS * _WIDTH / len(windows))
        for axes, last, window in zip(grid[0], grid[-1], windows, strict=True):
            kind, _, rest = window.title.partition(" ")
            name, _, amount = rest.partition(" ")
            lines = [fitted(each, letters) for each in (f"{kind} {name}", amount)]
            axes.set_title("\n".join(lines).strip(), loc="left", fontsize=7.5)
            ends = fan.time[window.records[[0, -1]]] - window.start
            unit, seconds = time_unit(float(ends[1]))
            last.set_xlim(ends / seconds)
            since = "time after the event" if window.title else "time"
            last.set_xlabel(f"{since if len(windows) < _COLUMNS else 'time'} [{unit}]")
        name_lines(figure, grid[0, 0])
    return figure


def _draw(axes: Axes, loops: DrawnLoops, fan: Fan, window: FanWindow, name: str) -> None:
    """Draw what the plants do in one signal after one event."""
    process, records = loops.plants.point.process, window.records
    factor, asked = display_factor(process.signal(name)), name in process.controlled
    time = fan.time[records] - window.start
    time = time / time_unit(float(time[-1]))[1]
    p05, p25, median, p75, p95 = fan.shares[name][:, records] * factor
    low, first, _, last, high = (f"{100.0 * chance:g}" for chance in CHANCES)
    bands = ((p05, p95, 0.18, f"{low} to {high} %"), (p25, p75, 0.4, f"{first} to {last} %"))
    for bottom, top, alpha, words in bands:
        axes.fill_between(
            time, bottom, top, color=PALETTE[0], alpha=alpha, linewidth=0.0,
            step=None if asked else "post", label=f"{words} of plants",
        )  # fmt: skip
    held = {} if asked else HELD
    axes.plot(time, median, color=PALETTE[0], linewidth=1.2, label="median", **held)
    axes.plot(time, fan.on_paper[name][records] * factor, **PAPER, **held)
    if asked:
        column = process.controlled.index(name)
        setpoint = loops.scenario.setpoints[records * fan.every, column]
        axes.plot(time, setpoint * factor, **SETPOINT)


def _records(process: Process, fan: Fan, segment: Segment) -> np.ndarray:
    """Return the records of an event until the plants have come to rest, and some before it."""
    period = float(fan.time[1] - fan.time[0])
    first = int(np.ceil(segment.start / period))
    stop = min(int(np.ceil(segment.stop / period)), len(fan.time))
    away = np.zeros(stop - first)
    for name in process.controlled:
        curves = np.vstack([fan.shares[name], fan.on_paper[name]])[:, first:stop]
        span = process.signal(name).span
        moved = np.nan_to_num(np.abs(curves - curves[:, -1:]) / span).max(axis=0)
        away = np.maximum(away, moved)
    restless = np.flatnonzero(away > _SETTLED * away.max(initial=0.0))
    length = _AFTER * (float(restless[-1]) + 2.0) if restless.size else np.inf
    end = int(min(first + max(length, 8.0), stop))
    return _thinned(max(0, first - int(np.ceil(_BEFORE * (end - first)))), end)


def _thinned(first: int, stop: int) -> np.ndarray:
    """Return at most so many records, evenly, with the first and the last."""
    count = min(stop - first, _POINTS)
    return np.unique(np.linspace(first, stop - 1, count).round().astype(int))
