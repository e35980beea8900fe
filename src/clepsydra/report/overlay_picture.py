"""The first events of a study as a still picture: what a page shows where no script runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape

import numpy as np

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.report.colours import MUTED, PALETTE
from clepsydra.report.drawing.shapes import FONT, element, path, shortened, text, width
from clepsydra.report.overlay import EventWindow, ShownSignal, event_title, shown_span
from clepsydra.report.small_axes import TO_BASELINE, Axes, Curve
from clepsydra.studies.result import Candidate

#: Columns, levels and manipulated variables at most.
_COLUMNS, _HELD, _MOVED = 3, 2, 1
#: Size of the letters, and of those of titles; width of the picture, room beside and above the
#: axes, between them, and below them for time and names, and the height of a row [points].
_LETTERS, _TITLE = 7.5, 9.0
_WIDTH, _LEFT, _RIGHT, _TOP, _BELOW = 691.0, 56.0, 7.0, 22.0, 48.0
_ROW, _APART, _BESIDE = 59.0, 18.0, 40.0
#: A signal spans at least so much of its axis as beside the one of its kind that moves most.
_LEAST = 0.3
#: Above and below what is shown, as a share of it; and what stands still, of its range.
_MARGIN, _STILL = 0.05, 1e-3
_HANDLE = 18.0


@dataclass(frozen=True, eq=False)
class EventChart:
    """What the first controllers make of one event in one signal, in display units.

    Parameters
    ----------
    shown : ShownSignal
    curves : tuple of Curve
        The setpoint where there is one, and then each controller.
    band : tuple of float
        Its ends, where there is one.
    ends : (float, float)
        Of the vertical axis.
    """

    shown: ShownSignal
    curves: tuple[Curve, ...]
    band: tuple[float, ...]
    ends: tuple[float, float]


def event_charts(
    window: EventWindow, signals: Sequence[ShownSignal], first: Sequence[Candidate]
) -> list[EventChart]:
    """Return the charts of an event, one a signal, over the time that the page shows at first.

    What looks like motion is motion: no axis is fine beside those of the same kind.

    Parameters
    ----------
    first : sequence of Candidate
        In the order of their colours.
    """
    charts = [_chart(window, shown, first) for shown in signals]
    shares = [np.ptp(each.ends) / shown_span(each.shown.signal) for each in charts]
    found = []
    for chart, share in zip(charts, shares, strict=True):
        shown, (low, high) = chart.shown, chart.ends
        alike = zip(charts, shares, strict=True)
        most = max(own for each, own in alike if each.shown.moved is shown.moved)
        more = max(0.0, (_LEAST * most - share) * shown_span(shown.signal) / 2.0)
        found.append(replace(chart, ends=(low - more, high + more)))
    return found


def _chart(window: EventWindow, shown: ShownSignal, first: Sequence[Candidate]) -> EventChart:
    run = first[0].run
    time = window.samples * run.scenario.sampling_period - window.segment.start
    seen = time <= window.view[1]
    time, samples = time[seen] / time_unit(window.view[1])[1], window.samples[seen]
    curves, wanted = [], shown.setpoint(run)
    if wanted is not None:
        curves.append(Curve(time, wanted[samples], MUTED, 0.8, held=True, dashes="3 1.5"))
    for place, each in enumerate(first):
        values = shown.values(each.run)[samples]
        curves.append(Curve(time, values, PALETTE[place], held=shown.moved))
    band = shown.band(run.process) or ()
    values = np.concatenate([band, *(each.y for each in curves)])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    more = max(_MARGIN * (high - low), _STILL * shown_span(shown.signal))
    return EventChart(shown, tuple(curves), band, (low - more, high + more))


def overlay_svg(
    windows: Sequence[EventWindow],
    signals: Sequence[ShownSignal],
    first: Sequence[Candidate],
    title: str,
) -> str:
    """Draw the first events in columns, and in rows what each controller makes of them.

    Parameters
    ----------
    first : sequence of Candidate
        In the order of their colours.
    title : str
        What the picture shows, for readers who do not see it.

    Returns
    -------
    str
        One ``<svg>`` element on white paper, for use inside HTML.
    """
    columns = [window for window in windows if not window.again][:_COLUMNS]
    chosen = [each for each in signals if not each.moved][:_HELD]
    chosen += [each for each in signals if each.moved][:_MOVED]
    rows = [each for each in signals if each in chosen]
    wide = (_WIDTH - _LEFT - _RIGHT + _BESIDE) / len(columns) - _BESIDE
    bottom = _TOP + len(rows) * (_ROW + _APART) - _APART
    shapes = []
    for column, window in enumerate(columns):
        left = _LEFT + column * (wide + _BESIDE)
        happens = event_title(first[0].run.process, window.segment)
        words = shortened(happens, wide, _TITLE)
        shapes.append(text(left, _TOP - 7.0, words, "start", font_size=_TITLE))
        for row, chart in enumerate(event_charts(window, rows, first)):
            time, top = chart.curves[0].x, _TOP + row * (_ROW + _APART)
            axes = Axes(left, top, wide, _ROW, (time[0], time[-1]), chart.ends)
            shapes += axes.frame(named=row == len(rows) - 1)
            shapes += map(axes.curve, chart.curves)
            shapes += map(axes.level, chart.band)
            if not column:
                shapes += _row_words(top + _ROW / 2.0, chart.shown)
        unit = time_unit(window.view[1])[0]
        shapes.append(text(left + wide / 2.0, bottom + 22.0, f"time after the event [{unit}]"))
    shapes += _legend(bottom + 40.0, first)
    size = {"xmlns": "http://www.w3.org/2000/svg", "viewBox": f"0 0 {_WIDTH:g} {bottom + _BELOW:g}"}
    content = "\n".join([f"<title>{escape(title)}</title>", *shapes])
    look = {"font_family": FONT, "font_size": _LETTERS}
    return element("svg", content, **size, role="img", **look)


def _row_words(middle: float, shown: ShownSignal) -> list[str]:
    """Return what a row shows and its unit, read from below."""
    name = shortened(shown.name, _ROW + _APART, _LETTERS)
    lines = (name, f"[{unit_text(shown.signal.shown_unit) or '1'}]")
    return [
        text(0, 0, line, transform=f"translate({x:g} {middle:g}) rotate(-90)")
        for x, line in zip((10.0, 20.0), lines, strict=True)
    ]


def _legend(middle: float, first: Sequence[Candidate]) -> list[str]:
    """Return the names of the controllers beside their colours."""
    shapes, x, room = [], 2.0, _WIDTH / len(first) - _HANDLE - 18.0
    for place, each in enumerate(first):
        name = shortened(each.controller.title, room, _LETTERS)
        shapes.append(path(f"M{x:.1f} {middle:.1f}h{_HANDLE:g}", 1.2, stroke=PALETTE[place]))
        shapes.append(text(x + _HANDLE + 6.0, middle + TO_BASELINE, name, "start"))
        x += _HANDLE + 18.0 + width(name, _LETTERS)
    return shapes
