"""Trend pictures of a report, written as SVG: the panels of `trends` in a hundredth of the time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clepsydra.base.words import time_unit
from clepsydra.loop.run import Run
from clepsydra.report.axes_box import draw_box, draw_legend, draw_right_numbers
from clepsydra.report.chart import LETTER, SIZE, WIDTH, Chart, Scale, thinned
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.inner_setpoint_curves import with_inner_setpoints
from clepsydra.report.panel_content import PanelContent, panel_content
from clepsydra.report.panels import Panel
from clepsydra.report.recording import Recording, recording_of
from clepsydra.report.trends import segment_words

_LEFT, _RIGHT = 44.0, 44.0
_STRIP, _EVENTS, _LEGEND, _FOOTER = 34.0, 14.0, 19.0, 30.0
_DASH = "4 2.5"
#: Letters of the strip above the panels [pt].
_SMALL = 6.5


def trend_svg(run: Run, panels: Sequence[Panel], title: str, prefix: str) -> str:
    """Draw panels of a run above each other with a shared time axis.

    As `trends.trend_figure`, but thinned to what can be seen: of noise the whole band stays.

    Parameters
    ----------
    run : Run
    panels : sequence of Panel
    title : str
        What it shows, for readers who do not see it.
    prefix : str
        Put before every identifier.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.report.panels import controlled_panels
    >>> plant = cl.load("quadruple-tank")
    >>> run = cl.simulate(plant, cl.design.simc(plant), duration="1 min")
    >>> trend_svg(run, controlled_panels(run), "levels", "a").count("<title>levels</title>")
    1
    """
    recording = recording_of(run)
    unit, seconds = time_unit(recording.end - float(recording.time[0]))
    time, end = recording.time / seconds, recording.end / seconds
    colours = signal_colours(run.process)
    strip = _STRIP if recording.segments else 0.0
    events = _EVENTS if recording.marks else 0.0
    heights = [72.0 * panel.height for panel in panels]
    chart = Chart(strip + events + sum(heights) + _LEGEND * len(heights) + _FOOTER, title, prefix)
    x = Scale(float(time[0]) - 0.012 * end, end, _LEFT, WIDTH - _RIGHT)
    if recording.segments:
        _draw_strip(chart, recording, seconds, x)
    marks = _hairlines(recording, seconds, x)
    if recording.marks:
        _draw_numbers(chart, recording, seconds, x, strip)
    top = strip + events
    for place, (panel, height) in enumerate(zip(panels, heights, strict=True)):
        top += _LEGEND
        colour = colours.get(panel.signal.name, INK)
        content = panel_content(panel, recording, time, colour)
        content = with_inner_setpoints(content, panel, run, time)
        last = place == len(panels) - 1
        _draw_panel(chart, content, x, (top, height), f"time [{unit}]" if last else "")
        bars = "".join(
            f"M{x.place(s.start / seconds):.1f} {top:.1f}v{height:.1f}"
            for s in recording.segments
            if s.start > 0.0
        )
        chart.lines(bars, MUTED, 0.5, 0.6)
        if marks:
            hairs = "".join(f"M{mark:.1f} {top:.1f}V{top + height:.1f}" for mark in marks)
            chart.lines(hairs, INK, 0.5, 0.8)
        top += height
    return chart.svg()


def _draw_panel(
    chart: Chart, content: PanelContent, x: Scale, room: tuple[float, float], x_label: str
) -> None:
    top, height = room
    y = Scale(content.bottom, content.top, top + height, top)
    for limit, edge in content.hatched:
        chart.hatched((x.start, x.end), (y.place(limit), y.place(edge)))
        chart.line((x.start, x.end), (y.place(limit),) * 2, MUTED, 0.7)
    draw_box(
        chart, x, y, x_label=x_label, y_label=content.unit, x_numbers=bool(x_label),
        ticks=(8, 4 if height > 45.0 else 3),
    )  # fmt: skip
    for curve in content.curves:
        places, values = thinned(x.places(curve.time), y.places(curve.values))
        if curve.held and len(places) and curve.time[-1] < x.high:
            places, values = np.append(places, x.end), np.append(values, values[-1])
        chart.curve(
            places, values, curve.colour, curve.width, dash=_DASH if curve.dashed else "",
            held=curve.held, opacity=curve.opacity,
        )  # fmt: skip
    for start, stop in _seen(content.saturated, x):
        chart.box((start, stop), (y.start - 0.075 * height, y.start), INK)
    if content.percent is not None:
        low, high = content.percent
        floor, top_share = (100.0 * (v - low) / (high - low) for v in (y.low, y.high))
        draw_right_numbers(chart, x.end, Scale(floor, top_share, y.start, y.end), "%")
    entries = [
        (name, INK, 4.0, "")
        if curve is None
        else (name, curve.colour, max(curve.width, 0.9), _DASH if curve.dashed else "")
        for name, curve in content.legend()
    ]
    draw_legend(chart, x.start, top - 4.5, entries, LETTER * SIZE)
    for words in content.beyond:
        chart.text(x.end, top - 4.5, words, anchor="end", colour=MUTED)


def _seen(stretches: Sequence[tuple[float, float]], x: Scale) -> list[tuple[float, float]]:
    """Return stretches as places, those that nobody can tell apart joined."""
    if not stretches:
        return []
    places = x.places(np.array(stretches))
    places[:, 1] = np.maximum(places[:, 1], places[:, 0] + 0.8)
    apart = np.flatnonzero(places[1:, 0] > np.maximum.accumulate(places[:, 1])[:-1] + 0.3) + 1
    firsts = np.concatenate(([0], apart))
    lasts = np.append(apart, len(places)) - 1
    return [
        (float(start), float(stop))
        for start, stop in zip(places[firsts, 0], places[lasts, 1], strict=True)
    ]


def _draw_strip(chart: Chart, recording: Recording, seconds: float, x: Scale) -> None:
    """Write above the panels what happens when."""
    for number, segment in enumerate(recording.segments):
        start, stop = x.place(segment.start / seconds), x.place(segment.stop / seconds)
        stop = min(stop, x.end)
        chart.box((start, stop), (1.0, _STRIP - 4.0), "#e4e8ed" if number % 2 else "#f0f2f5")
        letters = max(int((stop - start) / (LETTER * _SMALL)), 1)
        lines = [word for word in segment_words(recording.process, segment) if word]
        y = (_STRIP - 3.0) / 2 + 0.36 * _SMALL - 0.5 * 8.0 * (len(lines) - 1)
        for line, word in enumerate(lines):
            cut = word if len(word) <= letters else word[: letters - 1] + "…"
            middle = (start + stop) / 2
            chart.text(middle, y + 8.0 * line, cut, anchor="middle", size=_SMALL)


def _hairlines(recording: Recording, seconds: float, x: Scale) -> list[float]:
    """Return the places of events; those that nobody could tell apart are one."""
    places = {round(x.place(mark.time / seconds), 0) for mark in recording.marks}
    return sorted(places)


def _draw_numbers(chart: Chart, recording: Recording, seconds: float, x: Scale, top: float) -> None:
    """Write above the panels the number of each event that has room."""
    free = 0.0
    for number, mark in enumerate(recording.marks, 1):
        place, label = x.place(mark.time / seconds), mark.label(number)
        width = LETTER * _SMALL * len(label) + 3.0
        if place - width / 2 >= free:
            chart.text(place, top + 9.0, label, anchor="middle", size=_SMALL)
            free = place + width / 2
