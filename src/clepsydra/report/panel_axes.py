"""A panel of a trend picture on Matplotlib axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.panel_content import Curve, PanelContent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DASHES = (0, (4, 2.5))


def draw_panel(axes: Axes, content: PanelContent) -> None:
    """Draw a panel on its axes.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    content : PanelContent

    Examples
    --------
    >>> import clepsydra as cl
    >>> from matplotlib.figure import Figure
    >>> from clepsydra.report.panel_content import panel_content
    >>> from clepsydra.report.panels import all_panels
    >>> from clepsydra.report.recording import recording_of
    >>> run = cl.simulate(cl.load("quadruple-tank"), duration="60 s")
    >>> axes = Figure().add_subplot()
    >>> draw_panel(axes, panel_content(all_panels(run)[0], recording_of(run), run.time, "#0072B2"))
    >>> axes.get_ylabel()
    'cm'
    """
    for curve in content.curves:
        axes.plot(
            curve.time,
            curve.values,
            drawstyle="steps-post" if curve.held else "default",
            zorder=2.5 if curve.dashed else 2.0,
            **_style(curve),
        )
    axes.set_ylim(content.bottom, content.top)
    for limit, edge in content.hatched:
        axes.axhspan(limit, edge, facecolor=LIMIT, edgecolor="#9aa4af", hatch="////", lw=0)
        axes.axhline(limit, color=MUTED, linewidth=0.7)
    for words in content.beyond:
        axes.text(
            0.995, 1.03, words, transform=axes.transAxes, ha="right", va="bottom", color=MUTED
        )  # fmt: skip
    for start, stop in content.saturated:
        axes.axvspan(start, stop, 0.0, 0.075, facecolor=INK, edgecolor=INK, lw=1.2)
    axes.set_ylabel(content.unit)
    if content.percent is not None:
        _draw_percent(axes, *content.percent)
    _draw_legend(axes, content)


def _style(curve: Curve) -> dict[str, Any]:
    style: dict[str, Any] = {"color": curve.colour, "linewidth": curve.width}
    if curve.dashed:
        style["linestyle"] = _DASHES
    if curve.opacity != 1.0:
        style["alpha"] = curve.opacity
    return style


def _draw_percent(axes: Axes, low: float, high: float) -> None:
    percent = axes.secondary_yaxis(
        "right",
        functions=(
            lambda value: 100.0 * (np.asarray(value) - low) / (high - low),
            lambda share: low + (high - low) * np.asarray(share) / 100.0,
        ),
    )
    percent.set_ylabel("%")
    percent.yaxis.set_major_locator(_few_ticks())
    percent.spines["right"].set_visible(False)
    percent.tick_params(color=MUTED, labelcolor=MUTED)


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 2, 5, 10])


def _draw_legend(axes: Axes, content: PanelContent) -> None:
    from matplotlib.lines import Line2D

    saturation: dict[str, Any] = {"color": INK, "linewidth": 4.0, "solid_capstyle": "butt"}
    entries = content.legend()
    lines = []
    for _, curve in entries:
        style = saturation if curve is None else _style(curve)
        lines.append(Line2D([], [], **style | {"linewidth": max(style["linewidth"], 0.9)}))
    axes.yaxis.set_major_locator(_few_ticks())
    axes.legend(
        lines,
        [name for name, _ in entries],
        loc="lower left",
        bbox_to_anchor=(0.0, 0.98),
        ncols=len(entries),
    )
