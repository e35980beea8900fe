"""The picture of a tuning: what each further margin costs."""

from __future__ import annotations

import math

import numpy as np

from clepsydra.report.axes_box import draw_box
from clepsydra.report.chart import Chart, Scale
from clepsydra.report.colours import INK, MUTED
from clepsydra.studies.tuning.result import TuningResult

_WIDTH, _HEIGHT = 300.0, 190.0
_BOX_X, _BOX_Y = (48.0, 286.0), (158.0, 24.0)
#: From this ratio on the objective has a logarithmic scale.
_WIDE = 4.0
_FRONT, _CHOSEN = "#0072B2", "#D55E00"


def tuning_svg(tuning: TuningResult, title: str, prefix: str) -> str:
    """Draw the Pareto front of objective against max|S| with the chosen point and the start.

    Parameters
    ----------
    tuning : TuningResult
    title, prefix : str
        As for `trend_svg`.

    Examples
    --------
    `clepsydra.studies.tuning.tune.tune` returns a tuning:

    >>> from types import SimpleNamespace
    >>> front = SimpleNamespace(sensitivity=np.array([1.3, 2.0]), objective=np.array([0.9, 0.6]))
    >>> found = SimpleNamespace(front=front, objective=0.6, maximum_sensitivity=2.0,
    ...                         start_objective=1.0, start_maximum_sensitivity=1.5)
    >>> tuning_svg(found, "front", "a").count("<circle")  # two of the front, chosen and start
    4
    """
    front = tuning.front
    points = [
        (float(peak), float(value))
        for peak, value in zip(front.sensitivity, front.objective, strict=True)
    ]
    chosen = (tuning.maximum_sensitivity, tuning.objective)
    start = (tuning.start_maximum_sensitivity, tuning.start_objective)
    seen = [point for point in (*points, chosen, start) if all(map(math.isfinite, point))]
    chart = Chart(_HEIGHT, title, prefix, _WIDTH)
    values = [value for _, value in seen]
    # A margin that costs many times the score would press the rest of the front flat.
    wide = min(values) > 0.0 and max(values) > _WIDE * min(values)
    x = Scale(*_ends([peak for peak, _ in seen]), *_BOX_X)
    ends = (0.9 * min(values), 1.1 * max(values)) if wide else _ends(values)
    y = Scale(*ends, *_BOX_Y, logarithmic=wide)
    draw_box(chart, x, y, x_label="max|S|", y_label="objective", ticks=(6, 5))
    places = np.array([(x.place(peak), y.place(value)) for peak, value in points]).reshape(-1, 2)
    chart.curve(places[:, 0], places[:, 1], _FRONT, 1.2)
    for across, up in places:
        chart.circle(across, up, 2.0, _FRONT)
    for point, word, fill, edge in (
        (start, "start", "#ffffff", INK),
        (chosen, "chosen", _CHOSEN, _CHOSEN),
    ):
        if point in seen:
            left = x.place(point[0]) < (_BOX_X[0] + _BOX_X[1]) / 2
            chart.circle(x.place(point[0]), y.place(point[1]), 3.6, fill, edge, 1.2)
            chart.text(
                x.place(point[0]) + (7.0 if left else -7.0), y.place(point[1]) - 4.0, word,
                anchor="start" if left else "end", bold=True,
            )  # fmt: skip
    chart.text(_BOX_X[0], 12.0, "no other candidate beats a dot in both", colour=MUTED)
    return chart.svg()


def _ends(values: list[float]) -> tuple[float, float]:
    low, high = min(values), max(values)
    margin = max(0.1 * (high - low), 0.01 * abs(high), 1e-9)
    return low - margin, high + margin
