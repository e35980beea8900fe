"""A run as a small SVG: signals over time, and alarms as bars with their limits and deadbands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.loop.alarm_times import AlarmTimes
from clepsydra.process.alarm import LIMITS, AlarmKind
from clepsydra.process.process import Process
from clepsydra.report.colours import MUTED
from clepsydra.report.drawing.shapes import ALARM, TINTS, box, path, picture, text, width
from clepsydra.report.quantities import display_factor
from clepsydra.report.small_axes import Axes, Curve

#: The curves of a panel on a light page and on a dark one, and the grid.
_COLOURS = {
    "#0072b2": "#5cb0e6",
    "#d55e00": "#f4955a",
    "#009e73": "#3fc79c",
    "#7a3e9d": "#c39be0",
    "#7a5a00": "#d9b45a",
}
_GRID = {"#e6e9ed": "#262d35"}
_DEADBAND = TINTS[4]
#: In units of which a letter has 7.5: the picture and what stands at its sides, and the heights of
#: a panel, of the words above it, of the bar of an alarm, and of what stands below the last panel.
_LETTERS, _WIDTH, _LEFT, _RIGHT = 7.5, 420.0, 34.0, 8.0
_PANEL, _WORDS, _BAR, _FOOT = 84.0, 14.0, 13.0, 26.0
#: So long a run is shown in seconds, so that alarms come at whole numbers [s].
_IN_SECONDS = 600.0
#: Pixels to the unit, and room above and below the curves as a share of what they move.
_SCALE, _ROOM = 1.5, 0.08


@dataclass(frozen=True)
class _Panel:
    """Signals of one unit that share axes, and the alarms that look at them."""

    signals: tuple[Signal, ...]
    curves: tuple[Curve, ...]
    alarms: tuple[AlarmTimes, ...]

    @property
    def frame(self) -> float:
        """The height of its axes: more where there are limits to tell apart."""
        return _PANEL + _BAR * max(len(self.alarms) - 1, 0)

    @property
    def height(self) -> float:
        return _WORDS + _BAR * len(self.alarms) + self.frame


def run_picture(run: Any, drawn: str, points: int = 300) -> str:
    """Return signals and alarms of a run as the text of an SVG file.

    Parameters
    ----------
    run : Run or OpenLoopRun
    drawn : str
        Panels parted by "/", each with names of signals and alarms parted by commas. An alarm is a
        bar above its panel; one of a rate alone shows that rate.
    points : int
        How many a curve has at most, or nearly so.
    """
    last = float(run.time[-1])
    unit, seconds = time_unit(last) if last > _IN_SECONDS else ("s", 1.0)
    panels = [
        _panel(run, part.replace(" ", "").split(","), seconds, points) for part in drawn.split("/")
    ]
    ends, top, parts = (0.0, last / seconds), 2.0, []
    for place, panel in enumerate(panels):
        frame = _LEFT, top + panel.height - panel.frame, _WIDTH - _LEFT - _RIGHT, panel.frame
        limits = [*_limits(run, panel, seconds)]
        axes = Axes(
            *frame, ends, _range([*panel.curves, *(line for pair in limits for line in pair)])
        )
        parts += [
            *(_band(axes, *pair) for pair in limits),
            *axes.frame(named=place == len(panels) - 1),
        ]
        parts += [axes.curve(curve) for curve in (*(line for line, _ in limits), *panel.curves)]
        parts += _names(panel, top)
        for number, alarm in enumerate(panel.alarms):
            parts += _bar(alarm, axes, top + _WORDS + _BAR * number, seconds, unit)
        top += panel.height + 6.0
    parts.append(text(_WIDTH - _RIGHT, top + _FOOT - 9.0, f"time [{unit}]", "end", colour=MUTED))
    rules = "".join(
        f'.run [{what}="{light}"]{{{what}:light-dark({light},{dark})}}'
        for light, dark in (_COLOURS | _GRID).items()
        for what in ("fill", "stroke")
    )
    size = _WIDTH, top + _FOOT - 4.0
    room = {"width": f"{_SCALE * size[0]:.0f}", "height": f"{_SCALE * size[1]:.0f}"}
    named = ", ".join(signal.name for panel in panels for signal in panel.signals)
    title = f"{run.process.title}: {named} over time"
    return picture("run", size, title, rules, parts, font_size=_LETTERS, **room) + "\n"


def _panel(run: Any, names: list[str], seconds: float, points: int) -> _Panel:
    """Return what a panel shows of a run, over time in a unit of so many seconds."""
    known = {signal.name: signal for signal in run.signals}
    watched = {each.alarm.name: each for each in getattr(run, "alarms", ())}
    alarms = tuple(watched[name] for name in names if name in watched)
    shown = [known[name] for name in names if name not in watched]
    values = [_known(run, signal.name) * display_factor(shown[0]) for signal in shown]
    if not shown:
        measured = known[alarms[0].alarm.measurement]
        shown = [Signal(f"rate of {measured.name}", f"{unit_text(measured.shown_unit)}/s")]
        moved = np.diff(run.values[measured.name], prepend=run.values[measured.name][:1])
        values = [moved / run.process.sampling_period * display_factor(measured)]
    curves = tuple(
        _curve(run, signal.name, run.time / seconds, value, colour, points)
        for signal, value, colour in zip(shown, values, _COLOURS, strict=False)
    )
    return _Panel(tuple(shown), curves, alarms)


def _known(run: Any, name: str) -> np.ndarray:
    """Return the values of a signal; the stem of a valve has no place before its first step."""
    values = run.values[name]
    begins = run.values.get(f"{name.removesuffix('.stem')}.begins", np.zeros_like(values))
    return np.where(begins > 0.5, np.nan, values) if name.endswith(".stem") else values


def _curve(
    run: Any, name: str, time: np.ndarray, values: np.ndarray, colour: str, points: int
) -> Curve:
    """Return the curve of a signal, without the points that it goes through in a straight line."""
    setpoint = name.endswith(".setpoint")
    held = setpoint or name not in run.values or name in _held(run.process)
    every = max(1, len(time) // points)
    kept = _turns(values[::every], held)
    time, values = time[::every][kept], values[::every][kept]
    return Curve(time, values, colour, 1.4, held, "4 2" if setpoint else "")


def _turns(values: np.ndarray, held: bool) -> np.ndarray:
    """Return which points a curve needs, the first and the last among them [points]."""
    change = np.abs(np.diff(values, 1 if held else 2))
    turns = ~(change <= 1e-9 * max(np.nanmax(values) - np.nanmin(values), 1e-300))
    return np.concatenate([[True], turns[: len(values) - 2], [True]])


def _held(process: Process) -> set[str]:
    """Return the signals that hold from one sample to the next."""
    outside = (*process.inputs, *process.disturbances, *process.motion.memories)
    told = {e.name for e in process.elements if e.reporting() or getattr(e, "resolution", 0.0)}
    return told | {signal.name for signal in outside if not signal.name.endswith(".stem")}


def _limits(run: Any, panel: _Panel, seconds: float) -> Iterator[tuple[Curve, Curve]]:
    """Yield each alarm limit of a panel, and where the alarm returns to normal."""
    time, steady = run.time / seconds, np.ones_like(run.time)
    factor = (
        display_factor(run.process.signal(panel.alarms[0].alarm.measurement))
        if panel.alarms
        else 1.0
    )
    for alarm in (each.alarm for each in panel.alarms):
        limit, back = factor * alarm.limit, factor * (alarm.limit - alarm.deadband)
        if alarm.kind in LIMITS[2:]:
            back = factor * (alarm.limit + alarm.deadband)
        around = 0.0 * steady
        signs: tuple[float, ...] = (1.0,)
        if alarm.kind is AlarmKind.DEVIATION:
            around, signs = factor * run.values[f"{alarm.measurement}.setpoint"], (1.0, -1.0)
        elif alarm.kind is AlarmKind.RATE:
            signs = (1.0, -1.0)
        elif alarm.kind is AlarmKind.FLATLINE:
            signs = ()
        for sign in signs:
            ends = [around + sign * value * steady for value in (limit, back)]
            kept = _turns(ends[0], held=True)
            yield (
                Curve(time[kept], ends[0][kept], ALARM, 1.0, held=True, dashes="5 3"),
                Curve(time[kept], ends[1][kept], ALARM, held=True),
            )


def _range(curves: list[Curve]) -> tuple[float, float]:
    """Return between which values a panel shows its curves."""
    low = min(float(np.nanmin(curve.y)) for curve in curves)
    high = max(float(np.nanmax(curve.y)) for curve in curves)
    room = _ROOM * (high - low or 1.0)
    return low - room, high + room


def _band(axes: Axes, limit: Curve, back: Curve) -> str:
    """Return the deadband between an alarm limit and where the alarm returns to normal."""
    corners = [*limit.points.tolist(), *back.points[::-1].tolist()]
    data = "M" + "L".join(f"{axes.across(x):.1f} {axes.down(y):.1f}" for x, y in corners) + "Z"
    return path(data, 0.0, _DEADBAND, "none")


def _names(panel: _Panel, top: float) -> list[str]:
    """Return the names of the curves above a panel, and behind the last the unit of all."""
    parts, left = [], _LEFT
    for signal, curve in zip(panel.signals, panel.curves, strict=True):
        look = {"colour": curve.colour, "font_weight": 600}
        parts.append(text(left, top + 9.0, signal.name, "start", **look))
        left += width(signal.name, _LETTERS, bold=True) + 8.0
    if unit := unit_text(panel.signals[0].shown_unit):
        parts.append(text(left, top + 9.0, f"[{unit}]", "start", colour=MUTED))
    return parts


def _bar(each: AlarmTimes, axes: Axes, top: float, seconds: float, unit: str) -> list[str]:
    """Return when an alarm was there as bars with their times, and lines down to the curves."""
    low, high = top + 2.0, top + 10.0
    bottom, end = axes.top + axes.height, axes.x[1]
    parts = [text(axes.left - 4.0, high - 1.0, each.alarm.kind.short, "end", colour=ALARM)]
    for place, came in enumerate(each.came):
        returned = each.returned[place] / seconds if place < len(each.returned) else end
        left, right = axes.across(came / seconds), axes.across(returned)
        parts.append(box((left, right), (low, high), ALARM, "", None))
        parts.append(
            text(left - 2.0, high - 1.0, f"{came / seconds:g} {unit}", "end", colour=ALARM)
        )
        ways = [left]
        if returned < end:
            parts.append(
                text(right + 2.0, high - 1.0, f"{returned:g} {unit}", "start", colour=ALARM)
            )
            ways.append(right)
        lines = "".join(f"M{x:.1f} {high:.1f}V{bottom:.1f}" for x in ways)
        parts.append(path(lines, 0.6, stroke=ALARM, stroke_dasharray="1.5 2"))
    return parts
