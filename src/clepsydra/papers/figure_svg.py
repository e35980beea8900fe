"""Redrawn figures of a document as SVG: small multiples, two to a row."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.report.axes_box import draw_box
from clepsydra.report.chart import LETTER, SIZE, WIDTH, Chart, Scale, thinned
from clepsydra.report.colours import INK, MUTED, PALETTE

_LEFT, _RIGHT, _GAP = 46.0, 14.0, 58.0
_HEIGHT, _FOOTER, _LINE = 128.0, 34.0, 10.5
_WIDTHS = {"line": 1.2, "held": 1.2, "dashed": 0.9, "points": 0.0}
_DASH = "4 2.5"


def figure_svg(figure: Figure, prefix: str) -> str:
    """Draw a figure, its panels in rows of two.

    Parameters
    ----------
    figure : Figure
    prefix : str
        Put before every identifier, so that several pictures may share a page.

    Examples
    --------
    >>> time = np.linspace(0.0, 1.0, 20)
    >>> panel = Panel("level", "level [m]", (Curve("tank 1", time, np.exp(-time)),))
    >>> figure_svg(Figure("Fig. 1", "A tank", (panel,)), "a").count("tank 1")
    1
    """
    columns = 1 if len(figure.panels) == 1 else 2
    width = (WIDTH - _LEFT - _RIGHT - (columns - 1) * _GAP) / columns
    rows = [figure.panels[i : i + columns] for i in range(0, len(figure.panels), columns)]
    heads = [max(_head(panel, width) for panel in row) for row in rows]
    height = sum(heads) + len(rows) * (_HEIGHT + _FOOTER)
    chart = Chart(height, f"{figure.number} {figure.title}".strip(), prefix)
    colours = _colours(figure)
    top = 0.0
    for row, head in zip(rows, heads, strict=True):
        for column, panel in enumerate(row):
            left = _LEFT + column * (width + _GAP)
            box = (left, left + width), (top + head, top + head + _HEIGHT)
            _draw_panel(chart, panel, box, colours, top)
        top += head + _HEIGHT + _FOOTER
    return chart.svg()


def _colours(figure: Figure) -> dict[str, str]:
    """Give each label one colour in the whole figure; what is dashed and unnamed is grey."""
    labels = dict.fromkeys(c.label for panel in figure.panels for c in panel.curves if c.label)
    return {label: PALETTE[i % len(PALETTE)] for i, label in enumerate(labels)}


def _named(panel: Panel) -> list[Curve]:
    return list({curve.label: curve for curve in panel.curves if curve.label}.values())


def _legend_rows(panel: Panel, width: float) -> list[list[tuple[Curve, float]]]:
    """Break the names of curves into rows, each with its place from the left."""
    rows: list[list[tuple[Curve, float]]] = [[]]
    place = 0.0
    for curve in _named(panel):
        length = 27.0 + LETTER * SIZE * len(curve.label)
        if rows[-1] and place + length > width + _RIGHT:
            rows.append([])
            place = 0.0
        rows[-1].append((curve, place))
        place += length
    return rows


def _head(panel: Panel, width: float) -> float:
    return 8.0 + _LINE * (bool(panel.title) + len(_legend_rows(panel, width)))


def _draw_panel(
    chart: Chart,
    panel: Panel,
    box: tuple[tuple[float, float], tuple[float, float]],
    colours: dict[str, str],
    top: float,
) -> None:
    (left, right), (ceiling, floor) = box
    rows = _legend_rows(panel, right - left)
    baseline = ceiling - 5.0 - _LINE * (len(rows) - 1)
    if panel.title:
        chart.text(left, baseline - _LINE, panel.title, bold=True)
    x = _scale([c.x for c in panel.curves], left, right, panel.logarithmic_x, room=0.0)
    y = _scale([c.y for c in panel.curves], floor, ceiling, panel.logarithmic_y, room=0.05)
    draw_box(chart, x, y, x_label=panel.x_label, y_label=panel.y_label, ticks=(6, 4))
    clip = chart.clip((left, right), (ceiling - 2.0, floor + 2.0))
    for curve in panel.curves:
        _draw_curve(chart, curve, x, y, colours.get(curve.label, MUTED), clip)
    for row in rows:
        for curve, place in row:
            _draw_key(chart, curve, left + place, baseline, colours[curve.label])
        baseline += _LINE


def _draw_curve(chart: Chart, curve: Curve, x: Scale, y: Scale, colour: str, clip: str) -> None:
    across = np.where(curve.x > 0, curve.x, np.nan) if x.logarithmic else curve.x
    up = np.where(curve.y > 0, curve.y, np.nan) if y.logarithmic else curve.y
    places, values = x.places(across), y.places(up)
    if curve.kind == "points":
        for place, value in zip(places.tolist(), values.tolist(), strict=True):
            if math.isfinite(place) and math.isfinite(value):
                chart.circle(place, value, 1.6, colour)
        return
    along = bool(np.all(np.diff(curve.x) >= 0.0)) and bool(np.all(np.isfinite(places)))
    if along and curve.kind != "held":
        places, values = thinned(places, values)
    chart.curve(
        places, values, colour, _WIDTHS[curve.kind],
        dash=_DASH if curve.kind == "dashed" else "", held=curve.kind == "held", clip=clip,
    )  # fmt: skip


def _draw_key(chart: Chart, curve: Curve, x: float, y: float, colour: str) -> None:
    if curve.kind == "points":
        chart.circle(x + 7.0, y - 2.6, 1.8, colour)
    else:
        dash = _DASH if curve.kind == "dashed" else ""
        chart.line((x, x + 14.0), (y - 2.6, y - 2.6), colour, 1.4, dash)
    chart.text(x + 17.0, y, curve.label, colour=INK)


def _scale(
    values: list[np.ndarray], start: float, end: float, logarithmic: bool, *, room: float
) -> Scale:
    """Return a scale that holds all values, with some room at its ends."""
    every = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.zeros(0)
    if logarithmic:
        every = every[every > 0]
    if not every.size:
        return Scale(0.1 if logarithmic else 0.0, 1.0, start, end, logarithmic)
    low, high = float(every.min()), float(every.max())
    if logarithmic:
        factor = max((high / low) ** room, 1.001 if high > low else 2.0)
        return Scale(low / factor, high * factor, start, end, logarithmic=True)
    size = high - low
    if size <= 1e-12 * max(abs(low), abs(high)):
        size = max(abs(high), 1.0)
        room = 0.5
    return Scale(low - room * size, high + room * size, start, end)
