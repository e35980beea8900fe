"""A panel of a trend picture on Matplotlib axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.panels import Panel
from clepsydra.report.quantities import (
    display_factor,
    fitted,
    percent_scale,
    sensor_scale,
    short_text,
    unit_text,
)
from clepsydra.report.recording import Recording
from clepsydra.scores.effort import at_limit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

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
    axes : matplotlib.axes.Axes
    panel : Panel
    recording : Recording
    time : ndarray [samples]
        In the unit of the time axis.
    colour : str
        Of the signal.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from matplotlib.figure import Figure
    >>> from clepsydra.report.panels import all_panels
    >>> from clepsydra.report.recording import recording_of
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> axes = Figure().add_subplot()
    >>> draw_panel(axes, all_panels(run)[0], recording_of(run), run.time, "#0072B2")
    >>> axes.get_ylabel(), axes.texts[0].get_text()
    ('cm', 'rim 20 cm ↑')
    """
    signal, factor = panel.signal, display_factor(panel.signal)
    _draw_asked(axes, panel, recording, time, colour)
    for each in panel.beside:
        values = recording.values[each.name] * factor
        axes.plot(time, values, label=each.name, color=MUTED, linewidth=0.9, **_HELD)
    held = _HELD if panel.kind in ("input", "disturbance") else {}
    values = recording.values[signal.name] * factor
    (main,) = axes.plot(time, values, label=signal.name, color=colour, linewidth=1.4, **held)
    percent = None
    if panel.kind not in ("disturbance", "total"):
        percent = percent_scale(recording.process, signal.name)
        # What a sensor shows of a concentration or a flow ends at its range; a level, at the rim.
        by_sensor = percent if panel.kind == "state" else None
        low, high = (end * factor for end in by_sensor or (signal.low, signal.high))
        _set_view(axes, panel, low, high)
        _draw_limits(axes, panel, low, high)
    else:
        _set_view(axes, panel, np.nan, np.nan)
    if panel.kind == "input":
        _draw_saturation(axes, signal, recording, time)
    axes.set_ylabel(unit_text(signal.shown_unit) or "–")
    axes.yaxis.set_major_locator(_few_ticks())
    if percent is not None:
        _draw_percent(axes, percent[0] * factor, percent[1] * factor)
    _draw_legend(axes, main)


def _draw_asked(
    axes: Axes, panel: Panel, recording: Recording, time: np.ndarray, colour: str
) -> None:
    """Draw what inner loops ask, what a noisy sensor shows, setpoint and band, as levels."""
    name, factor = panel.measurement, display_factor(panel.signal)
    for inner in recording.inner:
        if inner.measurement in (name, panel.signal.name):
            values = recording.values[inner.name]
            if inner.measurement == name:
                values = sensor_scale(recording.process, name).to_state(values)
            words = f"inner setpoint of {inner.measurement}"
            axes.plot(time, values * factor, label=words, **_ASKED)
    if name in recording.noise:
        noisy = np.flatnonzero(recording.noise[name])
        stretch = slice(noisy[0], noisy[-1] + 1)
        scale = sensor_scale(recording.process, name)
        values = scale.to_state(recording.values[name][stretch]) * factor
        words = f"measured ({name})"
        axes.plot(time[stretch], values, label=words, color=colour, linewidth=0.5, alpha=0.45)
    if panel.controlled:
        scale = sensor_scale(recording.process, name)
        values = scale.to_state(recording.values[f"{name}.setpoint"]) * factor
        axes.plot(time, values, label=f"setpoint of {name}", **_ASKED)
    for end in recording.process.bands.get(name, ()):
        level = sensor_scale(recording.process, name).to_state(np.asarray(end))
        axes.axhline(float(level) * factor, label="band", color=INK, linewidth=0.8)


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


def _draw_percent(axes: Axes, low: float, high: float) -> None:
    percent = axes.secondary_yaxis(
        "right",
        functions=(
            lambda value: 100.0 * (np.asarray(value) - low) / (high - low),
            lambda share: low + (high - low) * np.asarray(share) / 100.0,
        ),
    )
    percent.set_ylabel("%")
    percent.yaxis.set_major_locator(_few_ticks())
    percent.spines["right"].set_visible(False)
    percent.tick_params(color=MUTED, labelcolor=MUTED)


def _few_ticks() -> Any:
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
