"""Events of a scenario in their own time windows, of every controller of a study: numbers to draw.

What moves where something happens is what an engineer looks at: each event starts at 0, its window
ends when the controllers that are shown first have settled, and points stand densely where curves
bend.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.loop.inner_setpoints import inner_loops, inner_setpoints
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Segment
from clepsydra.process.process import Process
from clepsydra.report.quantities import (
    change_text,
    display_factor,
    sensor_scale,
    shown_signal,
)
from clepsydra.report.ranking_rows import standing_word
from clepsydra.scores.plant_flows import forced_flows
from clepsydra.studies.result import Candidate, StudyResult
from clepsydra.studies.warnings.loop_response import LoopResponse

#: So many numbers a page holds in all, and so many points a window has at least and at most.
_NUMBERS, _FEWEST, _MOST = 110_000, 60, 300
#: Of the points, the share that lies before the end of the window.
_IN_VIEW = 0.75
#: What of the largest deviation is settled, and how much longer than that a window is.
_SETTLED, _AFTER = 0.04, 1.3
#: Samples that a window has at least, that of noise has, and the share that it shows before 0.
_SHORTEST, _OF_NOISE, _BEFORE = 20, 120, 0.06
#: Steps of rounding in what a curve spans, and in a signal's range.
_STEPS, _FINEST = 2000.0, 1e-6
#: Lengths of windows that read well, in powers of ten.
_ROUND = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True, eq=False)
class ShownSignal:
    """A row of charts: what is controlled with its setpoint, or a manipulated variable.

    Parameters
    ----------
    signal : Signal
    measurement : str
        The controlled measurement whose setpoint is drawn; empty for none.
    inner : bool
        Whether it is what inner loops measure, whose setpoints are each controller's own.
    """

    signal: Signal
    measurement: str = ""
    inner: bool = False

    @property
    def name(self) -> str:
        """What the reader knows it by: a level by the sensor that shows it."""
        return self.measurement or self.signal.name

    @property
    def moved(self) -> bool:
        """Whether it is a manipulated variable."""
        return not (self.measurement or self.inner)

    def values(self, run: Run) -> np.ndarray:
        """Return its trajectory in display units [samples]."""
        if self.signal.name == self.measurement:
            return run.true_measurement(self.measurement) * display_factor(self.signal)
        values = run.values[self.signal.name]
        if self.moved:  # what a controller asks of a forced flow is its command
            flows = forced_flows(run.process, run.time, run.values)
            values = flows.get(self.signal.name, values)
        return values * display_factor(self.signal)

    def band(self, process: Process) -> tuple[float, float] | None:
        """Return the ends of the band in display units; None where it has none."""
        if self.measurement not in process.bands:
            return None
        ends = self._read(process, np.array(process.bands[self.measurement]))
        low, high = (ends * display_factor(self.signal)).tolist()
        return low, high

    def setpoint(self, run: Run) -> np.ndarray | None:
        """Return the setpoint in display units [samples]; None where it has none."""
        factor = display_factor(self.signal)
        if self.inner:
            asked = inner_setpoints(run.controller, run.process)
            names = [each.name for each in asked if each.measurement == self.signal.name]
            return run.values[names[0]] * factor if names else None
        if not self.measurement:
            return None
        return self._read(run.process, run.values[f"{self.measurement}.setpoint"]) * factor

    def _read(self, process: Process, readings: np.ndarray) -> np.ndarray:
        """Return what readings of the measurement stand for, in SI of the signal."""
        if self.signal.name == self.measurement:
            return readings
        return sensor_scale(process, self.measurement).to_state(readings)


@dataclass(frozen=True, eq=False)
class EventWindow:
    """One event: which samples are drawn, and which of them are seen at first.

    Parameters
    ----------
    segment : Segment
    samples : ndarray [points]
        Numbers of the samples of a run, rising.
    view : (float, float)
        From when to when [s], counted from the event.
    again : bool
        Whether the same signal has stepped before, as on its way back; where levels average, in
        the same direction, since a band has two ends.
    """

    segment: Segment
    samples: np.ndarray
    view: tuple[float, float]
    again: bool


def shown_signals(result: StudyResult) -> list[ShownSignal]:
    """Return the rows of charts: what is controlled, what inner loops measure, what is moved."""
    process = result.process
    held = [ShownSignal(shown_signal(process, name)[0], name) for name in process.controlled]
    measured = [name for each in result.ranking for _, name in inner_loops(each.controller)]
    inner = [
        ShownSignal(process.signal(name), inner=True)
        for name in dict.fromkeys(measured)
        if name not in process.controlled
    ]
    moved = [ShownSignal(signal) for signal in process.inputs]
    # Where a level averages, the flow that it smooths is looked at first.
    return [*moved, *held, *inner] if process.averaging else [*held, *inner, *moved]


def event_windows(
    result: StudyResult, signals: Sequence[ShownSignal], first: Sequence[Candidate]
) -> list[EventWindow]:
    """Return the windows of the scenario's events, as long as the first candidates need to settle.

    Parameters
    ----------
    first : sequence of Candidate
        Shown before any other is asked for.
    """
    scenario = result.scenario
    period, segments = scenario.sampling_period, scenario.segments
    number = _NUMBERS // max(1, len(segments) * len(signals) * len(result.ranking))
    points = max(_FEWEST, min(_MOST, number))
    curves = np.array([[each.values(c.run) for each in signals] for c in first])
    held = [place for place, each in enumerate(signals) if not each.moved]
    spans = np.array([shown_span(signals[place].signal) for place in held])[:, None]
    windows, seen = [], set()
    for segment in segments:
        either = result.process.averaging and segment.kind == "load"
        kind = (segment.kind, segment.signal, bool(either and segment.size > 0.0))
        start, stop = (round(time / period) for time in (segment.start, segment.stop))
        stop = min(stop, scenario.samples)
        if segment.kind == "noise":
            end = min(stop, start + _OF_NOISE)
        else:
            end = start + _settled_after(curves[:, held, start:stop] / spans)
        length = min(_rounded((end - start) * period), (stop - start) * period)
        end = min(stop, start + math.ceil(length / period) + 1)
        before = max(0, start - math.ceil(_BEFORE * (end - start)))
        within = _bent(curves[..., before:end], round(_IN_VIEW * points)) + before
        beyond = _bent(curves[..., end:stop], points - len(within)) + end
        samples = np.unique(np.concatenate([within, [max(before, start - 1), start], beyond]))
        view = (-_BEFORE * length, length)
        windows.append(EventWindow(segment, samples, view, kind in seen))
        seen.add(kind)
    return windows


def _settled_after(shares: np.ndarray) -> int:
    """Return after how many samples all curves have come to rest, with some more of them.

    Parameters
    ----------
    shares : ndarray [controllers, signals, samples]
        Of the range of each signal: what moves little beside the others is at rest sooner.
    """
    away = np.nan_to_num(np.abs(shares - shares[..., -1:]), nan=0.0)
    last = np.flatnonzero(np.max(away, axis=(0, 1)) > _SETTLED * max(np.max(away), 1e-12))
    return max(_SHORTEST, round(_AFTER * (int(last[-1]) + 1 if last.size else 0)))


def _rounded(length: float) -> float:
    """Return the next longer time that reads well: 90 s, 20 min."""
    unit = next((each for each in (86400.0, 3600.0, 60.0) if length > 3.0 * each), 1.0)
    power = 10.0 ** math.floor(math.log10(length / unit))
    return next(r for r in _ROUND if r * power * unit >= 0.999 * length) * power * unit


def _bent(curves: np.ndarray, points: int) -> np.ndarray:
    """Return at most so many places, dense where any curve bends: the rule of equal error.

    The error of straight lines between points grows with the second difference and the square of
    their distance, so that their density goes with its root (de Boor, 1973,
    doi:10.1007/BFb0069121).
    """
    count = curves.shape[-1]
    if count <= points:
        return np.arange(count)
    bend = np.abs(np.diff(np.nan_to_num(curves), 2, axis=-1))
    spans = np.maximum(np.ptp(curves, axis=-1, keepdims=True), 1e-12)
    density = np.sqrt(np.max(bend / spans, axis=tuple(range(curves.ndim - 1))))
    density = np.pad(np.maximum(density, np.roll(density, 1)), 1, mode="edge")
    density = density / max(density.sum(), 1e-12) + 1.0 / count
    reached = np.cumsum(density) / density.sum()
    found = np.searchsorted(reached, np.linspace(0.0, 1.0, points))
    return np.unique(np.clip(found, 0, count - 1))


def event_title(process: Process, segment: Segment) -> str:
    """Return what happens, as the title of a window.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> event_title(load_process("quadruple-tank"), Segment("setpoint", "level_1", 0.0, 9.0, 1.0))
    'Setpoint level_1 +2 cm'
    """
    if segment.kind == "noise":
        return "Measurement noise"
    signal, size = process.signal(segment.signal), segment.size
    if segment.kind == "setpoint":
        signal, gain = shown_signal(process, segment.signal)
        size /= gain
    words = change_text(size * display_factor(signal), signal.shown_unit)
    return f"{segment.kind.capitalize()} {segment.signal} {words}"


def overlay_data(
    result: StudyResult,
    signals: Sequence[ShownSignal],
    windows: Sequence[EventWindow],
    first: Sequence[Candidate],
) -> dict[str, Any]:
    """Return the page's data: controllers, signals, and of each event the curves of all of them.

    A curve is a list of whole numbers, the first one and then each difference to the one before;
    times its `step`, in display units. What is not finite is null.
    """
    process, period = result.process, result.scenario.sampling_period
    curves = [[each.values(c.run) for each in signals] for c in result.ranking]
    leading = [result.ranking.index(each) for each in first]
    asked = [[each.setpoint(c.run) for each in signals] for c in result.ranking]
    events = []
    for window in windows:
        traces = []
        for row, signal in enumerate(signals):
            shown = [curves[place][row][window.samples] for place in leading]
            step = _step(signal.signal, shown)
            # The setpoints of outer loops are the scenario's, the same for all.
            setpoints = [own[row] for own in (asked if signal.inner else asked[:1])]
            told = [own if own is None else _coded(own[window.samples], step) for own in setpoints]
            drawn = [_coded(own[row][window.samples], step) for own in curves]
            traces.append({"step": step, "curves": drawn, "setpoints": told})
        start = round(window.segment.start / period)
        events.append(
            {
                "title": event_title(process, window.segment),
                "period": period,
                "samples": _coded((window.samples - start).astype(float), 1.0),
                "view": [float(f"{time:.6g}") for time in window.view],
                "again": window.again,
                "traces": traces,
            }
        )
    return {
        "controllers": [
            {
                "title": each.controller.title,
                "standing": standing_word(each),
                "peak": _finite(each.maximum_sensitivity),
                "error": _finite(each.relative_error),
            }
            for each in result.ranking
        ],
        "first": leading,
        "signals": [_described(each, process) for each in signals],
        "events": events,
    }


def _step(signal: Signal, shown: Sequence[np.ndarray]) -> float:
    """Return the step of rounding: fine beside what the first curves span."""
    spans = [float(np.ptp(values[np.isfinite(values)])) for values in shown if len(values)]
    return float(f"{max(max(spans, default=0.0) / _STEPS, _FINEST * shown_span(signal)):.2g}")


def shown_span(signal: Signal) -> float:
    """Return the range of a signal in display units, 1 where it has none.

    Examples
    --------
    >>> shown_span(Signal("level", "m", display_unit="cm", low=0.0, high=0.2))
    20.0
    """
    span = signal.span * display_factor(signal)
    return span if math.isfinite(span) and span > 0.0 else 1.0


def _coded(values: np.ndarray, step: float) -> list[int | None]:
    """Return values as whole steps, each as its difference to the one before."""
    finite = np.isfinite(values)
    whole = np.rint(np.where(finite, values, 0.0) / step).astype(np.int64)
    known = whole[finite]
    differences = iter(np.diff(known, prepend=0).tolist())
    return [next(differences) if each else None for each in finite]


def _described(shown: ShownSignal, process: Process) -> dict[str, Any]:
    signal = shown.signal
    factor, band = display_factor(signal), shown.band(process)
    return {
        "name": shown.name,
        "unit": unit_text(signal.shown_unit),
        "held": shown.moved,
        "low": _finite(signal.low * factor),
        "high": _finite(signal.high * factor),
        "band": band and [_finite(end) for end in band],
    }


def _finite(value: float) -> float | None:
    return float(f"{value:.6g}") if math.isfinite(value) else None


#: Frequencies to the decade, and decades below the highest frequency.
_PER_DECADE, _DECADES = 40, 4.0


def sensitivity_data(ranking: Sequence[Candidate]) -> dict[str, Any] | None:
    """Return frequencies [rad/s] and each controller's S at the measurements; None without any.

    Returns
    -------
    dict or None
        "frequencies", and in "curves" a list for each controller with null where its loop has no
        such frequency, or null for one without a linear loop.
    """
    responses = [each.response for each in ranking]
    ends = [float(each.frequencies[-1]) for each in responses if each is not None]
    if not ends:
        return None
    highest = np.log10(max(ends))
    grid = np.logspace(highest - _DECADES, highest, round(_DECADES * _PER_DECADE) + 1)
    return {
        "frequencies": [float(f"{each:.4g}") for each in grid],
        "curves": [None if each is None else _curve(each, grid) for each in responses],
    }


def _curve(response: LoopResponse, grid: np.ndarray) -> list[float | None]:
    sizes = np.linalg.svd(response.at_output, compute_uv=False)[:, 0]
    known = np.isfinite(sizes)
    found = np.interp(
        np.log(grid), np.log(response.frequencies[known]), sizes[known], left=np.nan, right=np.nan
    )
    return [float(f"{each:.3g}") if np.isfinite(each) else None for each in found]
