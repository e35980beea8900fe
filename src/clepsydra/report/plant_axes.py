"""What pictures of many plants share: how the plant on paper looks, the ends of axes, places."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.quantities import display_factor
from clepsydra.report.trends import few_ticks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Heights of the panel of a measurement and of an input [inch].
MEASURED, MOVED = 1.35, 0.95
HELD: dict[str, Any] = {"drawstyle": "steps-post"}
#: How the plant on paper and the setpoint look.
PAPER: dict[str, Any] = {"color": INK, "linewidth": 0.9, "label": "on paper"}
SETPOINT: dict[str, Any] = {
    **HELD, "color": MUTED, "linewidth": 0.9, "linestyle": (0, (4, 2.5)), "label": "setpoint",
    "zorder": 1.8,
}  # fmt: skip
#: Above and below what is shown, as a share of it, and of the signal's range.
_MARGIN, _STILL = 0.06, 0.005
#: An axis spans at least so much as beside the widest of its row.
_LEAST = 0.3
#: Of places, in shares of the picture.
_DIGITS = 5
#: On an inch.
_DOTS = 720.0


def set_ends(row: Sequence[Axes], signal: Signal) -> None:
    """Give axes of a signal ends that hold all that is drawn, and hatch beyond limits in view.

    What looks like motion is motion: no axis is fine beside the others of its row.
    """
    factor = display_factor(signal)
    still = _STILL * signal.span * factor if signal.has_range else 0.0
    found = []
    for axes in row:
        shown = _drawn(axes)
        bottom, top = (float(shown.min()), float(shown.max())) if shown.size else (0.0, 1.0)
        margin = max(_MARGIN * (top - bottom), still, 1e-3 * abs(top), 1e-9)
        found.append((bottom - margin, top + margin))
    widest = max(top - bottom for bottom, top in found)
    for axes, (bottom, top) in zip(row, found, strict=True):
        more = max(0.0, _LEAST * widest - (top - bottom)) / 2.0
        bottom, top = bottom - more, top + more
        axes.set_ylim(bottom, top)
        axes.yaxis.set_major_locator(few_ticks())
        for limit, edge in ((signal.high * factor, top), (signal.low * factor, bottom)):
            if bottom <= limit <= top:
                axes.axhspan(limit, edge, facecolor=LIMIT, edgecolor="#9aa4af", hatch="////", lw=0)


def name_lines(figure: Figure, axes: Axes) -> None:
    """Name above a figure what the axes of a measurement show, the setpoint last."""
    handles, labels = axes.get_legend_handles_labels()
    named = dict(zip(labels, handles, strict=True))
    named[SETPOINT["label"]] = named.pop(SETPOINT["label"])
    figure.legend(named.values(), named, loc="outside upper left", ncols=len(named))


def settle(figure: Figure) -> Figure:
    """Lay a figure out for good, in places that do not hang on the order of a solver's rows.

    Returns
    -------
    matplotlib.figure.Figure
        The same.
    """
    # Letters are as wide as their outlines only where they have many dots.
    dots = figure.dpi
    figure.set_dpi(_DOTS)
    figure.draw_without_rendering()
    figure.set_dpi(dots)
    found = {axes: axes.get_position().bounds for axes in figure.axes}
    figure.set_layout_engine("none")
    for axes, bounds in found.items():
        left, bottom, width, height = (round(each, _DIGITS) for each in bounds)
        axes.set_position((left, bottom, width, height))
    return figure


def _drawn(axes: Axes) -> np.ndarray:
    """Return the heights of all points that axes show."""
    lines = [np.asarray(line.get_ydata(), float) for line in axes.lines]
    paths = (path for each in axes.collections for path in each.get_paths())
    areas = [np.asarray(path.vertices, float)[:, 1] for path in paths]
    values = np.concatenate([*lines, *areas, np.zeros(0)])
    return values[np.isfinite(values)]
