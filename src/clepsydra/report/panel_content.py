"""What a panel of a trend picture shows, whoever draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.report.colours import INK, MUTED
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

#: Letters that a legend has room for beside the name of a limit, and those that a line takes.
_LEGEND_LETTERS, _HANDLE_LETTERS = 84, 7


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a panel.

    Parameters
    ----------
    name : str
        In the legend.
    time, values : ndarray [points]
        In the units of the axes.
    colour : str
    width : float
        [pt]
    dashed, held : bool
        `held` goes on level to the next point.
    opacity : float

    Examples
    --------
    >>> Curve("level", np.zeros(1), np.ones(1), "#0072B2", 1.4).held
    False
    """

    name: str
    time: np.ndarray
    values: np.ndarray
    colour: str
    width: float
    dashed: bool = False
    held: bool = False
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class PanelContent:
    """What a panel shows, in the units of its axes.

    Parameters
    ----------
    curves : tuple of Curve
        In the order in which they are drawn; the signal itself is `main`.
    main : Curve
    bottom, top : float
        Of the axis.
    hatched : tuple of (float, float)
        A limit and the edge of the picture beyond it.
    beyond : tuple of str
        Upper limits that are out of view.
    saturated : tuple of (float, float)
        When a manipulated variable stands at a limit.
    saturated_words : str
    unit : str
    percent : tuple of float or None
        Values at 0 and at 100 % of the sensor, or of the signal's own range.

    Examples
    --------
    See `panel_content`.
    """

    curves: tuple[Curve, ...]
    main: Curve
    bottom: float
    top: float
    hatched: tuple[tuple[float, float], ...]
    beyond: tuple[str, ...]
    saturated: tuple[tuple[float, float], ...]
    saturated_words: str
    unit: str
    percent: tuple[float, float] | None

    def legend(self) -> tuple[tuple[str, Curve | None], ...]:
        """Return name and curve of each entry, the signal first; None stands for saturation."""
        entries: list[tuple[str, Curve | None]] = [(self.main.name, self.main)]
        named = {curve.name: curve for curve in self.curves if curve is not self.main}
        entries += named.items()
        if self.saturated:
            entries.append((self.saturated_words, None))
        letters = _LEGEND_LETTERS // len(entries) - _HANDLE_LETTERS
        crowded = sum(len(name) + _HANDLE_LETTERS for name, _ in entries) > _LEGEND_LETTERS
        return tuple((fitted(name, letters) if crowded else name, c) for name, c in entries)


def panel_content(
    panel: Panel, recording: Recording, time: np.ndarray, colour: str
) -> PanelContent:
    """Return what a panel shows.

    Parameters
    ----------
    panel : Panel
    recording : Recording
    time : ndarray [samples]
        In the unit of the time axis.
    colour : str
        Of the signal.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.panels import all_panels
    >>> from clepsydra.report.recording import recording_of
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> shown = panel_content(all_panels(run)[0], recording_of(run), run.time, "#0072B2")
    >>> shown.unit, shown.beyond, shown.percent
    ('cm', ('rim 20 cm ↑',), (0.0, 20.0))
    """
    signal = panel.signal
    factor = display_factor(signal)
    held = panel.kind in ("input", "disturbance")
    values = recording.values[signal.name] * factor
    main = Curve(signal.name, time, values, colour, 1.4, held=held)
    measured, setpoint = _measurement(panel, recording, time, colour, factor)
    arriving = [
        Curve(each.name, time, recording.values[each.name] * factor, MUTED, 0.9, held=True)
        for each in panel.beside
    ]
    band = _band(panel, recording, time, factor)
    curves = (*measured, *setpoint, *arriving, *band, main)
    percent = None
    if panel.kind not in ("disturbance", "total"):
        percent = percent_scale(recording.process, signal.name)
    # What a sensor shows of a concentration or a flow ends at its range; a level, at the rim.
    by_sensor = percent if panel.kind == "state" else None
    low, high = (end * factor for end in by_sensor or (signal.low, signal.high))
    bottom, top = _view(panel, np.concatenate([curve.values for curve in curves]), low, high)
    hatched, beyond = _limits(panel, bottom, top, low, high)
    held_at_limit = _saturation(recording, signal, time) if panel.kind == "input" else ((), "")
    return PanelContent(
        curves,
        main,
        bottom,
        top,
        hatched,
        beyond,
        *held_at_limit,
        unit_text(signal.shown_unit) or "–",
        percent and (percent[0] * factor, percent[1] * factor),
    )


def _measurement(
    panel: Panel, recording: Recording, time: np.ndarray, colour: str, factor: float
) -> tuple[list[Curve], list[Curve]]:
    """Return what the sensor shows where it is noisy, and the setpoint, as levels."""
    noise = recording.noise.get(panel.measurement)
    if not panel.measurement or (noise is None and not panel.controlled):
        return [], []
    scale = sensor_scale(recording.process, panel.measurement)
    measured, setpoint = [], []
    if noise is not None:
        noisy = np.flatnonzero(noise)
        stretch = slice(noisy[0], noisy[-1] + 1)
        shown = scale.to_state(recording.values[panel.measurement][stretch]) * factor
        name = f"measured ({panel.measurement})"
        measured.append(Curve(name, time[stretch], shown, colour, 0.5, opacity=0.45))
    if panel.controlled:
        wanted = scale.to_state(recording.values[f"{panel.measurement}.setpoint"]) * factor
        name = f"setpoint of {panel.measurement}"
        setpoint.append(Curve(name, time, wanted, INK, 0.9, dashed=True, held=True))
    return measured, setpoint


def _band(panel: Panel, recording: Recording, time: np.ndarray, factor: float) -> list[Curve]:
    """Return the ends of the band of an averaging level, as levels; none without one."""
    ends = recording.process.bands.get(panel.measurement, ())
    scale = sensor_scale(recording.process, panel.measurement) if ends else None
    return [
        Curve("band", time, scale.to_state(np.full(len(time), end)) * factor, INK, 0.8)
        for end in ends
        if scale is not None
    ]


def _view(panel: Panel, shown: np.ndarray, low: float, high: float) -> tuple[float, float]:
    """Return the ends of the axis, from what is shown and its limits, in the units of the axis."""
    shown = shown[np.isfinite(shown)]
    bottom, top = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
    margin = max(0.08 * (top - bottom), 1e-3 * max(abs(top), abs(bottom)), 1e-9)
    if np.isfinite(low) and np.isfinite(high):
        span = high - low
        margin = max(margin, 0.01 * span)
        if panel.kind == "input":
            bottom, top, margin = min(bottom, low), max(top, high), 0.06 * span
        elif panel.kind in ("level", "state"):
            # A limit nearby is shown; what lies beyond one is never cut off.
            bottom = min(bottom, low) if bottom < low + 0.1 * span else bottom
            top = max(top, high) if top > high - 0.1 * span else top
    return bottom - margin, top + margin


def _limits(
    panel: Panel, bottom: float, top: float, low: float, high: float
) -> tuple[tuple[tuple[float, float], ...], tuple[str, ...]]:
    """Return the limits in view with the edge beyond each, and the names of those above it."""
    signal = panel.signal
    if panel.kind in ("disturbance", "total"):
        return (), ()
    word = {"level": "rim", "state": "top of range"}.get(panel.kind, "upper limit")
    hatched, beyond = [], []
    for value, edge, above in ((high, top, True), (low, bottom, False)):
        if np.isfinite(value) and bottom <= value <= top:
            hatched.append((value, edge))
        elif np.isfinite(value) and above:
            beyond.append(f"{word} {short_text(value)} {unit_text(signal.shown_unit)} ↑")
    return tuple(hatched), tuple(beyond)


def _saturation(
    recording: Recording, signal: Signal, time: np.ndarray
) -> tuple[tuple[tuple[float, float], ...], str]:
    """Return when the manipulated variable stands at a limit, and for how long in words."""
    limits = recording.limits.get(signal.name, (signal.low, signal.high))
    flags = at_limit(recording.values[signal.name], *limits)
    if not flags.any():
        return (), ""
    period = time[1] - time[0] if len(time) > 1 else 1.0
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(int), [0]))))
    stretches = tuple(
        (float(time[start]), float(time[stop - 1] + period)) for start, stop in edges.reshape(-1, 2)
    )
    lengths = np.diff(recording.time, append=recording.end)
    seconds = float(lengths[flags].sum())
    return stretches, f"at a limit for {time_text(seconds)}"
