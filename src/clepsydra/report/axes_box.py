"""The axes of a chart: a box with grid, ticks and their numbers."""

from __future__ import annotations

from clepsydra.report.chart import GRID, SIZE, Chart, Scale, tick_texts
from clepsydra.report.colours import INK, MUTED


def draw_box(
    chart: Chart,
    x: Scale,
    y: Scale,
    *,
    x_label: str = "",
    y_label: str = "",
    x_numbers: bool = True,
    ticks: tuple[int, int] = (8, 4),
) -> None:
    """Draw the grid, the two axes and their numbers; labels stand outside the numbers.

    Parameters
    ----------
    chart : Chart
    x, y : Scale
        Their places span the box.
    x_label, y_label : str
    x_numbers : bool
        Whether numbers stand under the box.
    ticks : tuple of int
        How many intervals x and y have at most.

    Examples
    --------
    >>> chart = Chart(80.0, "empty", "a")
    >>> draw_box(chart, Scale(0, 1, 40, 200), Scale(0, 1, 60, 10), y_label="cm")
    >>> chart.svg().count(">1.0<")
    2
    """
    across, up = x.ticks(ticks[0]), y.ticks(ticks[1])
    grid = "".join(f"M{x.place(v):.1f} {y.start:.1f}V{y.end:.1f}" for v in across)
    grid += "".join(f"M{x.start:.1f} {y.place(v):.1f}H{x.end:.1f}" for v in up)
    chart.lines(grid, GRID, 0.6)
    chart.lines(f"M{x.start:.1f} {y.end:.1f}V{y.start:.1f}H{x.end:.1f}", MUTED, 0.7)
    for value, words in zip(up, tick_texts(up), strict=True):
        chart.text(x.start - 3.5, y.place(value) + 0.36 * SIZE, words, anchor="end")
    if x_numbers:
        for value, words in zip(across, tick_texts(across), strict=True):
            chart.text(x.place(value), y.start + 9.5, words, anchor="middle")
        if x_label:
            chart.text((x.start + x.end) / 2, y.start + 20.0, x_label, anchor="middle")
    if y_label:
        middle = (y.start + y.end) / 2
        chart.text(x.start - 31.0, middle, y_label, anchor="middle", turned=True)


def draw_right_numbers(chart: Chart, x: float, scale: Scale, label: str) -> None:
    """Write the numbers of a second scale at the right edge of a box.

    Examples
    --------
    >>> chart = Chart(80.0, "empty", "a")
    >>> draw_right_numbers(chart, 200.0, Scale(0, 100, 60, 10), "%")
    >>> chart.svg().count("<text")
    4
    """
    ticks = scale.ticks(4)
    for value, words in zip(ticks, tick_texts(ticks), strict=True):
        chart.text(x + 4.0, scale.place(value) + 0.36 * SIZE, words, colour=MUTED)
    middle = (scale.start + scale.end) / 2
    chart.text(x + 32.0, middle, label, anchor="middle", turned=True)


def draw_legend(
    chart: Chart, x: float, y: float, entries: list[tuple[str, str, float, str]], letter: float
) -> float:
    """Write names in a row, each behind a piece of its line, and return where the row ends [pt].

    Parameters
    ----------
    chart : Chart
    x, y : float
        Left end, and baseline [pt].
    entries : list of (name, colour, width, dash)
    letter : float
        Room for one letter [pt].

    Examples
    --------
    >>> chart = Chart(20.0, "empty", "a")
    >>> draw_legend(chart, 0.0, 10.0, [("level", "#0072B2", 1.4, "")], 4.0)
    49.0
    """
    for name, colour, width, dash in entries:
        chart.line((x, x + 14.0), (y - 2.6, y - 2.6), colour, width, dash)
        chart.text(x + 17.0, y, name, colour=INK)
        x += 17.0 + letter * len(name) + 12.0
    return x
