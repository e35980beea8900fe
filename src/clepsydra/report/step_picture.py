"""Step responses of the linear model: every channel, dead time included."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text, time_unit
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.dead_time import without_dead_time
from clepsydra.linear.roots import PADE_ORDER
from clepsydra.linear.step_response import step_response
from clepsydra.report.colours import MUTED, signal_colours
from clepsydra.report.quantities import display_factor, short_text, unit_text
from clepsydra.report.response_axes import channel_picture, in_shares

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: The step of an input with a range, a share of it.
STEP = 0.1
_POINTS = 400
_SLOWEST_TIMES = 5.0
# A dead time below this share of the axis is drawn again, larger, as far as this many of it.
_HARDLY_SEEN = 0.1
_START = 4.0
_HEIGHT = 1.25


def step_figure(analysis: Analysis) -> Figure:
    """Draw what each output (rows) does after a step of each input (columns), from rest.

    A step is a tenth of the input's range, or one of its display units; outputs are deviations
    in display units. A dotted line stands at the end of the dead time.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import clepsydra as cl
    >>> figure = step_figure(cl.load("quadruple-tank").analysis)
    >>> figure.axes[0].get_title(loc="left")
    'level_1 after pump_1 +1 V'
    """
    colours = signal_colours(analysis.operating_point.process)
    times = _times(analysis)
    try:
        values = step_response(analysis.model, times)
    except InputError:  # dead times without a common measure
        values = step_response(without_dead_time(analysis.model, PADE_ORDER), times)
    unit, seconds = time_unit(float(times[-1]))
    shares = in_shares(analysis, values)
    with channel_picture(analysis, shares, _HEIGHT, cause=_step_words, sharex=True) as drawn:
        figure, grid, found = drawn
        for each in found:
            (axes,) = each.axes
            response = _size(each.moved) * values[:, each.row, each.column]
            response *= display_factor(each.output)
            axes.set_ylabel(unit_text(each.output.shown_unit) or "–")
            axes.axhline(0.0, color=MUTED, linewidth=0.5)
            colour = colours[each.output.name]
            axes.plot(times / seconds, response, color=colour, linewidth=1.4)
            late = analysis.dead_times[each.row, each.column]
            if late > 0.0:
                if late < _HARDLY_SEEN * times[-1]:
                    _draw_start(axes, times, response, late, colour)
                axes.axvline(late / seconds, color=MUTED, linewidth=0.8, linestyle=":")
                axes.annotate(
                    f"dead time {time_text(late)}", (late / seconds, 0.92), (3, 0),
                    ("data", "axes fraction"), "offset points",
                    va="top", fontsize=6.5, color=MUTED,
                )  # fmt: skip
        for axes in grid[-1]:
            axes.set_xlabel(f"time [{unit}]")
            axes.set_xlim(0.0, times[-1] / seconds)
    return figure


def _size(moved: Signal) -> float:
    """Return the size of the step of a manipulated variable [SI]."""
    return STEP * moved.span if math.isfinite(moved.span) else 1.0 / display_factor(moved)


def _step_words(moved: Signal) -> str:
    size = short_text(_size(moved) * display_factor(moved))
    return f"after {moved.name} +{size} {unit_text(moved.shown_unit)}".strip()


def _draw_start(
    axes: Axes, times: np.ndarray, response: np.ndarray, late: float, colour: str
) -> None:
    """Draw the first few dead times again, larger, inside the axes."""
    start = times <= _START * late
    inside = axes.inset_axes((0.6, 0.2, 0.38, 0.42))
    inside.plot(times[start], response[start], color=colour, linewidth=1.2)
    inside.axvline(late, color=MUTED, linewidth=0.8, linestyle=":")
    inside.set_xlim(0.0, _START * late)
    inside.tick_params(labelsize=6)
    inside.set_title("the start, in s", loc="left", fontsize=6.5, pad=2)
    inside.locator_params(axis="both", nbins=4)


def _times(analysis: Analysis) -> np.ndarray:
    """Return the times of the picture [s], closer where the dead times end."""
    times = [np.linspace(0.0, _duration(analysis), _POINTS)]
    for late in np.unique(analysis.dead_times[analysis.dead_times > 0.0]):
        times.append(np.linspace(0.0, min(_START * late, times[0][-1]), _POINTS // 4))
    return np.unique(np.concatenate(times))


def _duration(analysis: Analysis) -> float:
    """Return how long the slowest thing that shows takes [s]."""
    constants = analysis.time_constants[np.isfinite(analysis.time_constants)]
    times = list(np.abs(constants))
    delays = analysis.model.delays
    late = 0.0 if delays is None else float(delays.times.sum())
    if not times:
        times = [late or 20.0 * analysis.operating_point.process.sampling_period]
    # Equal tanks in series rise for the sum of their lags, which no single one shows.
    return max(_SLOWEST_TIMES * max(times), 2.0 * sum(times)) + late
