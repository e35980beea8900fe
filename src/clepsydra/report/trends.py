"""Trend pictures: small multiples on one time axis, with the scenario above them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text, time_unit
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.process.process import Process
from clepsydra.report.colours import INK, LIMIT, MUTED, signal_colours
from clepsydra.report.quantities import (
    change_text,
    display_factor,
    fitted,
    percent_scale,
    sensor_scale,
    short_text,
)
from clepsydra.report.recording import Panel, Recording, all_panels, recording_of
from clepsydra.scores.effort import at_limit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D


#: Figure style. The font comes with Matplotlib, so that text has the same width everywhere.
STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.6,
    "hatch.linewidth": 0.4,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "legend.borderpad": 0.1,
    "legend.borderaxespad": 0.1,
    "legend.handlelength": 2.2,
    "legend.columnspacing": 1.6,
    "path.simplify": True,
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.color": MUTED,
    "ytick.labelcolor": INK,
}

_WIDTH = 7.4
_LEFT, _RIGHT = 0.62, 0.6
_HEADER, _LEGEND, _FOOTER = 0.5, 0.27, 0.42
#: Height above the panels where there is no scenario, with and without events.
_EVENTS_HEADER, _NO_HEADER = 0.24, 0.1
#: Share of the width that the number of an event needs.
_NUMBER_WIDTH = 0.02


def trend_figure(run: Run | Simulation, panels: Sequence[Panel]) -> Figure:
    """Draw panels of a run above each other with a shared time axis.

    States are drawn in their display unit with percent of the range on the right, setpoints
    dashed, limits shaded; a bar on the time axis marks where a manipulated variable stands at a
    limit; the strip on top says what the scenario does. Vertical hairlines are events, numbered
    in order of time where there is room; one that happens often has one, with its count.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot: it belongs to nobody but the caller.
    """
    import matplotlib
    from matplotlib.figure import Figure

    recording = recording_of(run)
    unit, seconds = time_unit(recording.end - float(recording.time[0]))
    time = recording.time / seconds
    end = recording.end / seconds
    limits = (float(time[0]) - 0.012 * end, end)
    colours = signal_colours(run.process)
    header = _HEADER if recording.segments else _NO_HEADER
    if recording.marks:
        header += _EVENTS_HEADER
    height = header + sum(panel.height + _LEGEND for panel in panels) + _FOOTER
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(_WIDTH, height))
        top = height - header
        strips = []
        if recording.segments:
            strips.append(figure.add_axes(_box(height - _HEADER + 0.02, _HEADER - 0.06, height)))
            draw_strip(strips[0], run.process, recording.segments, seconds, limits)
        if recording.marks:
            strips.append(figure.add_axes(_box(top, _EVENTS_HEADER, height)))
            _draw_numbers(strips[-1], recording, seconds, limits)
        for axes in strips:
            axes.set(xlim=limits, ylim=(0.0, 1.0))
            axes.set_axis_off()
        first: Axes | None = None
        for panel in panels:
            top -= panel.height + _LEGEND
            axes = figure.add_axes(_box(top, panel.height, height), sharex=first)
            first = first or axes
            colour = colours.get(panel.signal.name, INK)
            draw_panel(axes, panel, recording, time, colour)
            for segment in recording.segments:
                axes.axvline(segment.start / seconds, color=MUTED, linewidth=0.5, alpha=0.6)
            _draw_hairlines(axes, recording, seconds)
            axes.tick_params(labelbottom=False)
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(f"time [{unit}]")
        axes.set_xlim(limits)
        figure.align_ylabels([entry for entry in figure.axes if entry not in strips])
    return figure


def segment_words(process: Process, segment: Segment) -> tuple[str, str, str]:
    """Return what happens in a segment: the kind, the signal and the size with its unit.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> process = load_process("quadruple-tank")
    >>> segment_words(process, Segment("setpoint", "level_1", 0.0, 400.0, 0.5))
    ('setpoint', 'level_1', '+0.5 V = +1 cm')
    """
    if segment.kind == "noise":
        return "measurement", "noise", ""
    signal = process.signal(segment.signal)
    size = change_text(segment.size * display_factor(signal), signal.shown_unit)
    if segment.signal in process.measured_state:
        level = process.signal(process.measured_state[segment.signal])
        if level.shown_unit != signal.shown_unit:
            change = segment.size / sensor_scale(process, segment.signal).gain
            size += f" = {change_text(change * display_factor(level), level.shown_unit)}"
    return segment.kind, segment.signal, size


def _box(bottom: float, axes_height: float, height: float) -> tuple[float, float, float, float]:
    width = (_WIDTH - _LEFT - _RIGHT) / _WIDTH
    return (_LEFT / _WIDTH, bottom / height, width, axes_height / height)


def draw_strip(
    axes: Axes,
    process: Process,
    segments: Sequence[Segment],
    seconds: float,
    limits: tuple[float, float],
) -> None:
    """Write above the panels what happens when.

    Parameters
    ----------
    seconds : float
        Of a unit of the time axis.
    limits : (float, float)
        Its ends.
    """
    inches = (_WIDTH - _LEFT - _RIGHT) / (limits[1] - limits[0])
    for index, segment in enumerate(segments):
        start, stop = segment.start / seconds, min(segment.stop / seconds, limits[1])
        axes.axvspan(start, stop, facecolor="#f0f2f5" if index % 2 == 0 else "#e4e8ed", lw=0)
        letters = max(int((stop - start) * inches / 0.062), 1)
        words = filter(None, segment_words(process, segment))
        lines = [fitted(word, letters) for word in words]
        axes.text(
            (start + stop) / 2.0, 0.5, "\n".join(lines), ha="center", va="center",
            fontsize=6.5, linespacing=1.15,
        )  # fmt: skip


def _draw_hairlines(axes: Axes, recording: Recording, seconds: float) -> None:
    if recording.marks:
        # In shares of the panel's height, so that the lines do not widen its range.
        axes.vlines(
            [mark.time / seconds for mark in recording.marks], 0.0, 1.0,
            transform=axes.get_xaxis_transform(), color=INK, linewidth=0.5, alpha=0.8, zorder=1.5,
        )  # fmt: skip


def _draw_numbers(
    axes: Axes, recording: Recording, seconds: float, limits: tuple[float, float]
) -> None:
    """Write above the panels the number of each event that has room."""
    _draw_hairlines(axes, recording, seconds)
    free = limits[0] - 1.0
    for number, mark in enumerate(recording.marks, 1):
        time, label = mark.time / seconds, mark.label(number)
        width = _NUMBER_WIDTH * (limits[1] - limits[0]) * max(1.0, len(label) / 2)
        if time - width / 2 >= free:
            axes.text(
                time, 0.5, label, ha="center", va="center", fontsize=6.5,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
            )  # fmt: skip
            free = time + width / 2


def plot(run: Run | Simulation) -> Figure:
    """Draw everything that a run recorded: states, manipulated variables, disturbances, events."""
    return trend_figure(run, all_panels(run))


#: Letters that a legend has room for beside the name of a limit, and those that a line takes.
_LEGEND_LETTERS, _HANDLE_LETTERS = 84, 7
_HELD: dict[str, Any] = {"drawstyle": "steps-post"}
_ASKED: dict[str, Any] = {
    **_HELD, "color": INK, "linewidth": 0.9, "linestyle": (0, (4, 2.5)), "zorder": 2.5,
}  # fmt: skip


def draw_panel(
    axes: Axes, panel: Panel, recording: Recording, time: np.ndarray, colour: str
) -> None:
    """Draw a signal with its setpoint, limits and percent on axes of its own.

    Parameters
    ----------
    time : ndarray [samples]
        In the unit of the time axis.
    colour : str
        Of the signal.
    """
    signal, factor = panel.signal, display_factor(panel.signal)
    _draw_asked(axes, panel, recording, time, colour)
    for each in panel.beside:
        values = recording.values[each.name] * factor
        axes.plot(time, values, label=each.name, color=MUTED, linewidth=0.9, **_HELD)
    held = _HELD if panel.kind in ("input", "disturbance") else {}
    values = recording.values[signal.name] * factor
    (main,) = axes.plot(time, values, label=signal.name, color=colour, linewidth=1.4, **held)
    percent, low, high = None, np.nan, np.nan
    if panel.kind not in ("disturbance", "total"):
        percent = percent_scale(recording.process, signal.name)
        # What a sensor shows of a concentration or a flow ends at its range; a level, at the rim.
        by_sensor = percent if panel.kind == "state" else None
        low, high = (end * factor for end in by_sensor or (signal.low, signal.high))
    _set_view(axes, panel, low, high)
    _draw_limits(axes, panel, low, high)
    if panel.kind == "input":
        _draw_saturation(axes, signal, recording, time)
    axes.set_ylabel(unit_text(signal.shown_unit) or "–")
    axes.yaxis.set_major_locator(few_ticks())
    if percent is not None:
        draw_percent(axes, percent[0] * factor, percent[1] * factor)
    _draw_legend(axes, main)


def _draw_asked(
    axes: Axes, panel: Panel, recording: Recording, time: np.ndarray, colour: str
) -> None:
    """Draw what inner loops ask, what a noisy sensor shows, setpoint and band, as levels."""
    name, factor = panel.measurement, display_factor(panel.signal)

    def level(readings: np.ndarray) -> np.ndarray:
        return sensor_scale(recording.process, name).to_state(readings) * factor

    for inner in recording.inner:
        if inner.measurement in (name, panel.signal.name):
            asked = recording.values[inner.name]
            values = level(asked) if inner.measurement == name else asked * factor
            axes.plot(time, values, label=f"inner setpoint of {inner.measurement}", **_ASKED)
    if name in recording.noise:
        noisy = np.flatnonzero(recording.noise[name])
        stretch = slice(noisy[0], noisy[-1] + 1)
        values, words = level(recording.values[name][stretch]), f"measured ({name})"
        axes.plot(time[stretch], values, label=words, color=colour, linewidth=0.5, alpha=0.45)
    if panel.controlled:
        values = level(recording.values[f"{name}.setpoint"])
        axes.plot(time, values, label=f"setpoint of {name}", **_ASKED)
    for end in recording.process.bands.get(name, ()):
        axes.axhline(float(level(np.asarray(end))), label="band", color=INK, linewidth=0.8)


def _set_view(axes: Axes, panel: Panel, low: float, high: float) -> None:
    """Set the ends of the axis, from what is shown and its limits, in the units of the axis."""
    shown = np.concatenate([np.asarray(line.get_ydata(), float) for line in axes.lines])
    shown = shown[np.isfinite(shown)]
    bottom, top = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
    margin = max(0.08 * (top - bottom), 1e-3 * max(abs(top), abs(bottom)), 1e-9)
    span = high - low
    if np.isfinite(span):
        margin = max(margin, 0.01 * span)
        if panel.kind == "input":
            bottom, top, margin = min(bottom, low), max(top, high), 0.06 * span
        else:
            # A limit nearby is shown; what lies beyond one is never cut off.
            bottom = min(bottom, low) if bottom < low + 0.1 * span else bottom
            top = max(top, high) if top > high - 0.1 * span else top
    axes.set_ylim(bottom - margin, top + margin)


def _draw_limits(axes: Axes, panel: Panel, low: float, high: float) -> None:
    """Hatch what lies beyond the limits in view, and name an upper one that is out of it."""
    bottom, top = axes.get_ylim()
    for limit, edge in ((high, top), (low, bottom)):
        if bottom <= limit <= top:
            axes.axhspan(limit, edge, facecolor=LIMIT, edgecolor="#9aa4af", hatch="////", lw=0)
            axes.axhline(limit, color=MUTED, linewidth=0.7)
    if np.isfinite(high) and high > top:
        word = {"level": "rim", "state": "top of range"}.get(panel.kind, "upper limit")
        words = f"{word} {short_text(high)} {unit_text(panel.signal.shown_unit)} ↑"
        axes.text(
            0.995, 1.03, words, transform=axes.transAxes, ha="right", va="bottom", color=MUTED
        )  # fmt: skip


def _draw_saturation(axes: Axes, signal: Signal, recording: Recording, time: np.ndarray) -> None:
    """Mark on the time axis when a manipulated variable stands at a limit, and say for how long."""
    limits = recording.limits.get(signal.name, (signal.low, signal.high))
    flags = at_limit(recording.values[signal.name], *limits)
    if not flags.any():
        return
    period = time[1] - time[0] if len(time) > 1 else 1.0
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(int), [0]))))
    for start, stop in edges.reshape(-1, 2):
        end = time[stop - 1] + period
        axes.axvspan(time[start], end, 0.0, 0.075, facecolor=INK, edgecolor=INK, lw=1.2)
    seconds = float(np.diff(recording.time, append=recording.end)[flags].sum())
    words = f"at a limit for {time_text(seconds)}"
    axes.plot([], [], label=words, color=INK, linewidth=4.0, solid_capstyle="butt")


def draw_percent(axes: Axes, low: float, high: float) -> None:
    """Add percent on the right; 0 and 100 % stand for these values of the axis."""
    percent = axes.secondary_yaxis(
        "right",
        functions=(
            lambda value: 100.0 * (np.asarray(value) - low) / (high - low),
            lambda share: low + (high - low) * np.asarray(share) / 100.0,
        ),
    )
    percent.set_ylabel("%")
    percent.yaxis.set_major_locator(few_ticks())
    percent.spines["right"].set_visible(False)
    percent.tick_params(color=MUTED, labelcolor=MUTED)


def few_ticks() -> Any:
    """Return what places four round numbers on an axis at most."""
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 2, 5, 10])


def _draw_legend(axes: Axes, main: Line2D) -> None:
    """Name each line once above the axes, the signal first."""
    handles, labels = axes.get_legend_handles_labels()
    named = {str(main.get_label()): main} | dict(zip(labels, handles, strict=True))
    letters = _LEGEND_LETTERS // len(named) - _HANDLE_LETTERS
    crowded = sum(len(name) + _HANDLE_LETTERS for name in named) > _LEGEND_LETTERS
    legend = axes.legend(
        named.values(), [fitted(name, letters) if crowded else name for name in named],
        loc="lower left", bbox_to_anchor=(0.0, 0.98), ncols=len(named),
    )  # fmt: skip
    for line in legend.get_lines():
        line.set_linewidth(max(line.get_linewidth(), 0.9))
