"""Redrawn figures of a document by Matplotlib: small multiples, two to a row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.papers.figure import Curve, Figure, Panel
from clepsydra.report.colours import MUTED, PALETTE
from clepsydra.report.trends import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

#: Width of the picture, and height of a row without and for each line of its legend [inch].
_WIDTH, _ROW, _LINE = 7.4, 2.3, 0.16
#: Letters of a legend that a row of panels has room for, by the number of its columns.
_LETTERS = {1: 110, 2: 50}
_LOOKS: dict[str, dict[str, Any]] = {
    "line": {"linewidth": 1.2},
    "held": {"linewidth": 1.2, "drawstyle": "steps-post"},
    "dashed": {"linewidth": 0.9, "linestyle": "--"},
    "points": {"linestyle": "none", "marker": "o", "markersize": 3.0},
}


def drawn(figure: Figure) -> Picture:
    """Draw a figure, its panels in rows of two."""
    import matplotlib
    from matplotlib.figure import Figure as Picture

    columns = 1 if len(figure.panels) == 1 else 2
    rows = -(-len(figure.panels) // columns)
    lines = sum(
        max(_lines(panel, columns) for panel in figure.panels[first : first + columns])
        for first in range(0, len(figure.panels), columns)
    )
    colours = _colours(figure)
    with matplotlib.rc_context(STYLE):
        picture = Picture(figsize=(_WIDTH, rows * _ROW + lines * _LINE), layout="constrained")
        grid = picture.subplots(rows, columns, squeeze=False).ravel()
        for axes, panel in zip(grid, figure.panels, strict=False):
            _draw(axes, panel, colours, columns)
        for axes in grid[len(figure.panels) :]:
            axes.remove()
    return picture


def _colours(figure: Figure) -> dict[str, str]:
    """Give each label one colour in the whole figure; what is dashed and unnamed is grey."""
    labels = dict.fromkeys(c.label for panel in figure.panels for c in panel.curves if c.label)
    return {label: PALETTE[i % len(PALETTE)] for i, label in enumerate(labels)}


def _named(panel: Panel) -> list[Curve]:
    return list({curve.label: curve for curve in panel.curves if curve.label}.values())


def _beside(panel: Panel, columns: int) -> int:
    """Return how many names stand beside each other in a legend."""
    longest = max((len(curve.label) + 8 for curve in _named(panel)), default=1)
    return max(1, min(len(_named(panel)), _LETTERS[columns] // longest))


def _lines(panel: Panel, columns: int) -> int:
    return -(-len(_named(panel)) // _beside(panel, columns))


def _draw(axes: Axes, panel: Panel, colours: dict[str, str], columns: int) -> None:
    told = set()
    for curve in panel.curves:
        across = np.where(curve.x > 0, curve.x, np.nan) if panel.logarithmic_x else curve.x
        up = np.where(curve.y > 0, curve.y, np.nan) if panel.logarithmic_y else curve.y
        label = curve.label if curve.label not in told else ""
        told.add(curve.label)
        axes.plot(
            across, np.where(np.isfinite(up), up, np.nan), label=label or "_",
            color=colours.get(curve.label, MUTED), **_LOOKS[curve.kind],
        )  # fmt: skip
    axes.set(
        xlabel=panel.x_label, ylabel=panel.y_label,
        xscale="log" if panel.logarithmic_x else "linear",
        yscale="log" if panel.logarithmic_y else "linear",
    )  # fmt: skip
    if told - {""}:
        axes.legend(
            loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=_beside(panel, columns),
            title=panel.title or None, alignment="left", title_fontproperties={"weight": "bold"},
        )  # fmt: skip
    elif panel.title:
        axes.set_title(panel.title, loc="left", fontweight="bold")
