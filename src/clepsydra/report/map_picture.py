"""The controllers of a study in one picture: how well each controls against how robust it is."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.report.axes_box import draw_box
from clepsydra.report.chart import WIDTH, Chart, Scale
from clepsydra.report.colours import MUTED
from clepsydra.report.quantities import short_text
from clepsydra.studies.result import Standing, StudyResult

_HEIGHT = 190.0
_BOX_X, _BOX_Y = (48.0, WIDTH - 14.0), (158.0, 24.0)
#: Radius of a point, and the room that its number needs around its middle.
_POINT, _ROOM = 3.2, 6.2
_LIMIT = "#D55E00"
#: Beyond these a controller is out of the question, and the others would be squeezed together.
_WORST_PEAK, _WORST_ERROR = 10.0, 100.0
#: Fill and edge of a point.
_LOOKS = {
    Standing.ROBUST: ("#0072B2", "#0072B2"),
    Standing.NERVOUS: ("#ffffff", "#0072B2"),
    Standing.STABLE: ("#ffffff", "#D55E00"),
    Standing.OUTSIDE: ("#ffffff", "#59636e"),
    Standing.UNSAFE: ("#d8dde3", "#59636e"),
}
_WORDS = {
    Standing.ROBUST: "robust and quiet",
    Standing.NERVOUS: "robust, nervous",
    Standing.STABLE: "thin margins",
    Standing.OUTSIDE: "leaves its band",
    Standing.UNSAFE: "unsafe",
}


def map_svg(result: StudyResult, title: str, prefix: str) -> str:
    """Draw each controller as a point with its rank: to the left is robust, below a small error.

    Every point stands where its numbers are; where several stand close, their ranks are written
    further off, each with a line to its point. What is beyond max|S| 10 or a hundred times the
    smallest error stands at the edge; a law that switches has no max|S| and is left out.

    Parameters
    ----------
    result : StudyResult
    title, prefix : str
        As for `trend_svg`.

    Returns
    -------
    str
        Empty where there are fewer than two controllers with margins.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant), cl.design.amigo(plant)])
    >>> map_svg(result, "ranks", "a").count("<circle")  # one is in the legend
    3
    """
    shown = [c for c in result.ranking if not math.isnan(c.maximum_sensitivity)]
    if len(shown) < 2:
        return ""
    peaks = [min(_finite(c.maximum_sensitivity, _WORST_PEAK), _WORST_PEAK) for c in shown]
    errors = [max(c.relative_error, 1e-9) for c in shown]
    least = min(errors)
    errors = [min(_finite(e, math.inf), _WORST_ERROR * least) for e in errors]
    chart = Chart(_HEIGHT, title, prefix)
    x = Scale(0.95, max(2.3, 1.12 * max(peaks)), *_BOX_X, logarithmic=True)
    y = Scale(0.8 * least, max(1.35 * max(errors), 2.2 * least), *_BOX_Y, logarithmic=True)
    chart.box((x.place(SENSITIVITY_LIMIT), x.end), _BOX_Y, "#f6f0ec")
    draw_box(chart, x, y, x_label="max|S| (smaller is more robust)", y_label="relative error")
    chart.line((x.place(SENSITIVITY_LIMIT),) * 2, _BOX_Y, _LIMIT, 0.8)
    words = f"limit {short_text(SENSITIVITY_LIMIT)}"
    chart.text(x.place(SENSITIVITY_LIMIT), _BOX_Y[1] - 4.0, words, anchor="middle", colour=_LIMIT)
    points = [(x.place(p), y.place(e)) for p, e in zip(peaks, errors, strict=True)]
    labels: list[tuple[float, float]] = []
    for point in points:
        place = _free(point, points, labels)
        labels.append(place)
        distance = math.dist(point, place)
        if distance > 2.0 * _ROOM:  # up to the number, and not through it
            reach = 1.0 - 0.8 * _ROOM / distance
            end = [a + reach * (b - a) for a, b in zip(point, place, strict=True)]
            chart.line((point[0], end[0]), (point[1], end[1]), MUTED, 0.5)
    for candidate, point in zip(shown, points, strict=True):
        chart.circle(*point, _POINT, *_LOOKS[candidate.standing], 1.2)
    for candidate, place in zip(shown, labels, strict=True):
        chart.text(place[0], place[1] + 2.7, str(candidate.rank), anchor="middle")
    across = _BOX_X[0]
    for standing in sorted({candidate.standing for candidate in shown}):
        chart.circle(across + 4.0, 9.0, _POINT, *_LOOKS[standing], 1.2)
        chart.text(across + 11.0, 11.8, _WORDS[standing])
        across += 90.0
    return chart.svg()


def _finite(value: float, other: float) -> float:
    return value if math.isfinite(value) else other


def _free(
    point: tuple[float, float],
    points: Sequence[tuple[float, float]],
    labels: Sequence[tuple[float, float]],
) -> tuple[float, float]:
    """Return the place nearest to a point where its number covers no point and no other number."""
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    for radius in np.arange(_POINT + _ROOM, 100.0, 3.0):
        for turn in turns:
            spot = (point[0] + radius * math.cos(turn), point[1] - radius * math.sin(turn))
            inside = (
                _BOX_X[0] + _ROOM < spot[0] < _BOX_X[1] - _ROOM
                and _BOX_Y[1] + _ROOM < spot[1] < _BOX_Y[0] - _ROOM
            )
            apart = all(math.dist(spot, other) > 2.0 * _ROOM + 0.6 for other in labels)
            if inside and apart and all(math.dist(spot, p) > _POINT + _ROOM - 0.1 for p in points):
                return spot
    return point
