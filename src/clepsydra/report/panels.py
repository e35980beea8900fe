"""Panels of a trend picture: one signal each, with its limits, on a shared time axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.loop.open_loop import Simulation
from clepsydra.loop.run import Run
from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.quantities import (
    display_factor,
    fitted,
    sensor_scale,
    short_text,
    unit_text,
)
from clepsydra.report.recording import Recording
from clepsydra.scores.effort import at_limit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Legend = list[tuple[str, dict[str, Any]]]

#: Letters that a legend has room for beside the name of a limit, and those that a line takes.
_LEGEND_LETTERS, _HANDLE_LETTERS = 84, 7


@dataclass(frozen=True)
class Panel:
    """One panel: which signal it shows and how tall it is.

    Parameters
    ----------
    kind : {"level", "state", "input", "disturbance", "total"}
        "state" for a state that is no level.
    signal : Signal
    height : float
        [inch]
    measurement : str
        The sensor that shows a level, empty for none.
    controlled : bool

    Examples
    --------
    >>> Panel("input", Signal("pump_1", "V", low=0.0, high=10.0), height=0.85).controlled
    False
    """

    kind: str
    signal: Signal
    height: float
    measurement: str = ""
    controlled: bool = False


def controlled_panels(run: Run) -> list[Panel]:
    """Return one panel for each level that follows a setpoint.

    Examples
    --------
    >>> from clepsydra.study.study import run_study
    >>> run = run_study("quadruple-tank").ranking[0].run
    >>> [panel.signal.name for panel in controlled_panels(run)]
    ['tank_1.level', 'tank_2.level']
    """
    process = run.process
    return [
        Panel("level", process.signal(process.measured_state[name]), 1.3, name, True)
        for name in process.controlled
    ]


def all_panels(run: Run | Simulation) -> list[Panel]:
    """Return the panels of a whole run: states, manipulated variables, disturbances that act.

    Volumes spilt are shown where something was spilt.

    Examples
    --------
    >>> from clepsydra.study.study import run_study
    >>> run = run_study("quadruple-tank").ranking[0].run
    >>> [panel.signal.name for panel in all_panels(run)][2:6]
    ['tank_3.level', 'tank_4.level', 'pump_1', 'pump_2']
    """
    process = run.process
    sensors = {state: name for name, state in reversed(process.measured_state.items())}
    controlled = [] if isinstance(run, Simulation) else controlled_panels(run)
    shown = {panel.signal.name for panel in controlled}
    height = 0.72 if controlled else 0.95
    others = [
        Panel(_kind(signal), signal, height, sensors.get(signal.name, ""))
        for signal in process.state
        if signal.name not in shown
    ]
    inputs = [Panel("input", signal, 0.85) for signal in process.inputs]
    disturbances = [
        Panel("disturbance", signal, 0.45)
        for signal in process.disturbances
        if np.ptp(run.values[signal.name]) > 0.0
    ]
    totals = [
        Panel("total", signal, 0.45)
        for signal in process.motion.totals
        if signal.name in run.values and np.ptp(run.values[signal.name]) > 0.0
    ]
    return [*controlled, *others, *inputs, *disturbances, *totals]


def _kind(signal: Signal) -> str:
    return "level" if signal.name.endswith(".level") else "state"


def draw_panel(
    axes: Axes, panel: Panel, recording: Recording, time: np.ndarray, colour: str
) -> None:
    """Draw one panel on its axes.

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
    >>> from clepsydra.study.study import run_study
    >>> run = run_study("quadruple-tank").ranking[0].run
    >>> from matplotlib.figure import Figure
    >>> from clepsydra.report.recording import recording_of
    >>> axes, panel = Figure().add_subplot(), controlled_panels(run)[0]
    >>> draw_panel(axes, panel, recording_of(run), run.time, "#0072B2")
    >>> axes.get_ylabel()
    'cm'
    """
    signal = panel.signal
    factor = display_factor(signal)
    values = recording.values[signal.name] * factor
    held = panel.kind in ("input", "disturbance")
    legend: Legend = [(signal.name, {"color": colour, "linewidth": 1.6})]
    shown = [values]
    if panel.measurement:
        legend += _draw_measurement(axes, panel, recording, time, colour, factor, shown)
    axes.plot(
        time, values, color=colour, linewidth=1.4, drawstyle="steps-post" if held else "default"
    )
    _set_view(axes, panel, np.concatenate(shown), factor)
    if panel.kind == "input":
        legend += _draw_saturation(axes, recording, panel.signal, time)
    axes.set_ylabel(unit_text(signal.shown_unit) or "–")
    if panel.kind not in ("disturbance", "total"):
        _draw_percent(axes, signal, factor)
    _draw_legend(axes, legend)


def _draw_measurement(
    axes: Axes,
    panel: Panel,
    recording: Recording,
    time: np.ndarray,
    colour: str,
    factor: float,
    shown: list[np.ndarray],
) -> Legend:
    noise = recording.noise.get(panel.measurement)
    if noise is None and panel.measurement not in recording.controlled:
        return []
    scale = sensor_scale(recording.process, panel.measurement)
    legend: Legend = []
    if noise is not None:
        measured = scale.to_state(recording.values[panel.measurement]) * factor
        noisy = np.flatnonzero(noise)
        stretch = slice(noisy[0], noisy[-1] + 1)
        style: dict[str, Any] = {"color": colour, "linewidth": 0.5, "alpha": 0.45}
        axes.plot(time[stretch], measured[stretch], **style)
        shown.append(measured[stretch])
        legend.append((f"measured ({panel.measurement})", style | {"linewidth": 1.6}))
    if panel.controlled:
        setpoint = scale.to_state(recording.values[f"{panel.measurement}.setpoint"]) * factor
        style = {"color": INK, "linewidth": 0.9, "linestyle": (0, (4, 2.5))}
        axes.plot(time, setpoint, drawstyle="steps-post", zorder=2.5, **style)
        shown.append(setpoint)
        legend.append((f"setpoint of {panel.measurement}", style))
    return legend


def _set_view(axes: Axes, panel: Panel, shown: np.ndarray, factor: float) -> None:
    """Choose the axis range, shade what lies beyond the limits, and name limits out of view."""
    signal = panel.signal
    low, high = signal.low * factor, signal.high * factor
    shown = shown[np.isfinite(shown)]
    bottom, top = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
    bounded = np.isfinite(low) and np.isfinite(high)
    margin = max(0.08 * (top - bottom), 1e-3 * max(abs(top), abs(bottom)), 1e-9 * factor)
    if bounded:
        span = signal.span * factor
        margin = max(margin, 0.01 * span)
        if panel.kind == "input":
            bottom, top, margin = min(bottom, low), max(top, high), 0.06 * span
        elif panel.kind in ("level", "state"):
            # A limit nearby is shown; what lies beyond one is never cut off.
            bottom = min(bottom, low) if bottom < low + 0.1 * span else bottom
            top = max(top, high) if top > high - 0.1 * span else top
    axes.set_ylim(bottom - margin, top + margin)
    words = ("rim", "floor") if panel.kind == "level" else ("upper limit", "lower limit")
    if panel.kind == "state":
        words = ("top of range", "bottom of range")
    for value, word, arrow, above in ((high, words[0], "↑", True), (low, words[1], "↓", False)):
        if panel.kind in ("disturbance", "total") or not np.isfinite(value):
            continue
        if bottom - margin <= value <= top + margin:
            edge = top + margin if above else bottom - margin
            axes.axhspan(value, edge, facecolor=LIMIT, edgecolor="#9aa4af", hatch="////", lw=0)
            axes.axhline(value, color=MUTED, linewidth=0.7)
        elif above:
            axes.text(
                0.995,
                1.03,
                f"{word} {short_text(value)} {unit_text(signal.shown_unit)} {arrow}",
                transform=axes.transAxes,
                ha="right",
                va="bottom",
                color=MUTED,
            )


def _draw_saturation(axes: Axes, recording: Recording, signal: Signal, time: np.ndarray) -> Legend:
    """Mark on the time axis where the manipulated variable stands at a limit."""
    saturated = at_limit(recording.values[signal.name], signal.low, signal.high)
    if not saturated.any():
        return []
    period = time[1] - time[0] if len(time) > 1 else 1.0
    for start, stop in _stretches(saturated):
        axes.axvspan(
            time[start], time[stop - 1] + period, 0.0, 0.075, facecolor=INK, edgecolor=INK, lw=1.2
        )
    lengths = np.diff(recording.time, append=recording.end)
    seconds = float(lengths[saturated].sum())
    style = {"color": INK, "linewidth": 4.0, "solid_capstyle": "butt"}
    return [(f"at a limit for {short_text(seconds)} s", style)]


def _stretches(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return [start, stop) of every run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(int), [0]))))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def _draw_percent(axes: Axes, signal: Signal, factor: float) -> None:
    span = signal.span * factor
    if not np.isfinite(span) or span <= 0.0:
        return
    low = signal.low * factor
    percent = axes.secondary_yaxis(
        "right",
        functions=(
            lambda value: 100.0 * (np.asarray(value) - low) / span,
            lambda share: low + span * np.asarray(share) / 100.0,
        ),
    )
    percent.set_ylabel("%")
    percent.yaxis.set_major_locator(_few_ticks())
    percent.spines["right"].set_visible(False)
    percent.tick_params(color=MUTED, labelcolor=MUTED)


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 2, 5, 10])


def _draw_legend(axes: Axes, legend: Sequence[tuple[str, dict[str, Any]]]) -> None:
    from matplotlib.lines import Line2D

    letters = _LEGEND_LETTERS // len(legend) - _HANDLE_LETTERS
    crowded = sum(len(name) + _HANDLE_LETTERS for name, _ in legend) > _LEGEND_LETTERS
    axes.yaxis.set_major_locator(_few_ticks())
    axes.legend(
        [Line2D([], [], **style) for _, style in legend],
        [fitted(name, letters) if crowded else name for name, _ in legend],
        loc="lower left",
        bbox_to_anchor=(0.0, 0.98),
        ncols=len(legend),
    )
