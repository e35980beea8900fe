"""One drawn plant beside the one on paper, over the whole scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.loop.run import Run
from clepsydra.report.colours import MUTED, PALETTE
from clepsydra.report.plant_axes import (
    HELD,
    MEASURED,
    MOVED,
    PAPER,
    SETPOINT,
    name_lines,
    set_ends,
)
from clepsydra.report.quantities import display_factor, percent_scale
from clepsydra.report.response_axes import picture
from clepsydra.report.trends import draw_percent, draw_strip

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Height of what happens when [inch], and points of a curve at most.
_STRIP, _POINTS = 0.42, 600


def replay_figure(run: Run, on_paper: Run, words: str) -> Figure:
    """Draw what one plant does beside the plant on paper: what is controlled, and what is moved.

    Parameters
    ----------
    run, on_paper : Run
        Of the same scenario and controller.
    words : str
        What the plant is called.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.robustness(cl.design.simc(plant), plant, draws=20, sensitivity=False)
    >>> figure = replay_figure(found.run(7), found.run(0), "draw 7")
    >>> [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]
    ['level_3', 'feed']
    """
    process, scenario = on_paper.process, on_paper.scenario
    controlled, moved = process.controlled, on_paper.controller.manipulated
    every = -(-on_paper.samples // _POINTS)
    unit, seconds = time_unit(scenario.duration)
    time, limits = on_paper.time[::every] / seconds, (0.0, scenario.duration / seconds)
    looks: tuple[tuple[Run, dict[str, Any]], ...] = (
        (run, {"color": PALETTE[1], "linewidth": 1.3, "label": words}),
        (on_paper, PAPER),
    )
    heights = [_STRIP, *[MEASURED] * len(controlled), *[MOVED] * len(moved)]
    size = len(heights), 1, sum(heights) / len(heights)
    with picture(*size, sharex=True, gridspec_kw={"height_ratios": heights}) as (figure, grid):
        strip, *rows = grid[:, 0].tolist()
        draw_strip(strip, process, scenario.segments, seconds, limits)
        strip.set_axis_off()
        for axes, name in zip(rows, (*controlled, *moved), strict=True):
            signal, asked = process.signal(name), name in controlled
            factor = display_factor(signal)
            for each, look in looks:
                values = each.true_measurement(name) if asked else each.values[name]
                held = {} if asked else HELD
                axes.plot(time, _finite(values[::every] * factor), **look, **held)
            if asked:
                setpoint = on_paper.values[f"{name}.setpoint"][::every]
                axes.plot(time, setpoint * factor, **SETPOINT)
            set_ends([axes], signal)
            axes.set_title(name, loc="left", fontsize=7.5)
            axes.set_ylabel(unit_text(signal.shown_unit) or "–")
            scale = percent_scale(process, name)
            if scale is not None:
                draw_percent(axes, scale[0] * factor, scale[1] * factor)
            for segment in scenario.segments:
                axes.axvline(segment.start / seconds, color=MUTED, linewidth=0.5, alpha=0.6)
        rows[-1].set_xlabel(f"time [{unit}]")
        rows[-1].set_xlim(limits)
        name_lines(figure, rows[0])
    return figure


def _finite(values: np.ndarray) -> np.ndarray:
    return np.where(np.isfinite(values), values, np.nan)
