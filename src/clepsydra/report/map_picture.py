"""The controllers of a study in one picture: how well each controls against how robust it is."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.report.axes_box import draw_box
from clepsydra.report.chart import WIDTH, Chart, Scale
from clepsydra.report.colours import INK, MUTED
from clepsydra.report.quantities import short_text
from clepsydra.study.ranking import ROBUST
from clepsydra.study.result import Candidate, Standing, StudyResult

_HEIGHT = 190.0
_BOX_X, _BOX_Y = (48.0, WIDTH - 14.0), (158.0, 24.0)
_RADIUS = 6.2
_LIMIT = "#D55E00"
#: Beyond these a controller is out of the question, and the others would be squeezed together.
_WORST_PEAK, _WORST_ERROR = 10.0, 100.0
#: Fill, edge and colour of the number.
_LOOKS = {
    Standing.ROBUST: ("#0072B2", "#0072B2", "#ffffff"),
    Standing.NERVOUS: ("#ffffff", "#0072B2", INK),
    Standing.STABLE: ("#ffffff", "#D55E00", INK),
    Standing.UNSAFE: ("#d8dde3", "#59636e", INK),
}
_WORDS = {
    Standing.ROBUST: "robust and quiet",
    Standing.NERVOUS: "robust, nervous",
    Standing.STABLE: "thin margins",
    Standing.UNSAFE: "unsafe",
}


def map_svg(result: StudyResult, title: str, prefix: str) -> str:
    """Draw each controller as its rank: to the left is robust, below is a small error.

    What is beyond max|S| 10 or a hundred times the smallest error stands at the edge; a law that
    switches has no max|S| and is left out.

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
    >>> from clepsydra.study.study import run_study
    >>> result = run_study("equalisation-tank")
    >>> map_svg(result, "ranks", "a").count("<circle") >= len(result.ranking)
    True
    """
    shown = [c for c in result.ranking if not math.isnan(c.maximum_sensitivity)]
    if len(shown) < 2:
        return ""
    peaks = [min(_finite(c.maximum_sensitivity, _WORST_PEAK), _WORST_PEAK) for c in shown]
    errors = [max(c.mean_error, 1e-9) for c in shown]
    least = min(errors)
    errors = [min(_finite(e, math.inf), _WORST_ERROR * least) for e in errors]
    chart = Chart(_HEIGHT, title, prefix)
    x = Scale(0.95, max(2.3, 1.12 * max(peaks)), *_BOX_X, logarithmic=True)
    y = Scale(0.8 * least, max(1.35 * max(errors), 2.2 * least), *_BOX_Y, logarithmic=True)
    chart.box((x.place(ROBUST), x.end), _BOX_Y, "#f6f0ec")
    draw_box(chart, x, y, x_label="max|S| (smaller is more robust)", y_label="mean error, × best")
    chart.line((x.place(ROBUST),) * 2, _BOX_Y, _LIMIT, 0.8)
    words = f"limit {short_text(ROBUST)}"
    chart.text(x.place(ROBUST), _BOX_Y[1] - 4.0, words, anchor="middle", colour=_LIMIT)
    taken: list[tuple[float, float]] = []
    for peak, error in zip(peaks, errors, strict=True):
        home = (x.place(peak), y.place(error))
        place = _free(home, taken)
        taken.append(place)
        if place != home:
            chart.line((home[0], place[0]), (home[1], place[1]), MUTED, 0.6)
    for candidate, place in zip(shown, taken, strict=True):
        _draw_rank(chart, candidate, place)
    across = _BOX_X[0]
    for standing in sorted({candidate.standing for candidate in shown}):
        fill, edge, _ = _LOOKS[standing]
        chart.circle(across + 4.0, 9.0, 4.0, fill, edge, 1.2)
        chart.text(across + 11.0, 11.8, _WORDS[standing])
        across += 90.0
    return chart.svg()


def _finite(value: float, other: float) -> float:
    return value if math.isfinite(value) else other


def _free(home: tuple[float, float], taken: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the place nearest to home where a number covers no other."""
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    spots = [home] + [
        (home[0] + radius * math.cos(turn), home[1] + radius * math.sin(turn))
        for radius in np.arange(4.0, 80.0, 4.0)
        for turn in turns
    ]
    for spot in spots:
        inside = (
            _BOX_X[0] + _RADIUS < spot[0] < _BOX_X[1] - _RADIUS
            and _BOX_Y[1] + _RADIUS < spot[1] < _BOX_Y[0] - _RADIUS
        )
        if inside and all(math.dist(spot, other) > 2.0 * _RADIUS + 0.6 for other in taken):
            return spot
    return home


def _draw_rank(chart: Chart, candidate: Candidate, place: tuple[float, float]) -> None:
    fill, edge, ink = _LOOKS[candidate.standing]
    chart.circle(*place, _RADIUS, fill, edge, 1.2)
    chart.text(place[0], place[1] + 2.7, str(candidate.rank), anchor="middle", colour=ink)
