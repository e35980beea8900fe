"""Bode pictures: magnitude and phase of every channel, exact with dead time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.response import frequency_response
from clepsydra.report.colours import MUTED, signal_colours
from clepsydra.report.facts import gain_factor, gain_unit
from clepsydra.report.response_axes import (
    channel_picture,
    in_shares,
    mark_frequencies,
    shown_frequencies,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Magnitudes are shown over this share of the largest.
_FLOOR = 1e-6
_HEIGHT = 1.05


def bode_figure(analysis: Analysis) -> Figure:
    """Draw magnitude and phase from each input (columns) to each output (rows).

    Magnitudes are in display units of output per input, phases continuous in degrees; the
    line has the colour of the output, dotted lines stand at the poles' frequencies.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import clepsydra as cl
    >>> len(bode_figure(cl.load("quadruple-tank").analysis).axes)  # 2 × 2, two each
    8
    """
    omegas = shown_frequencies(analysis)
    gains = frequency_response(analysis.model, omegas)
    colours = signal_colours(analysis.operating_point.process)
    corners = np.unique(np.abs(analysis.poles[np.abs(analysis.poles) > 0.0]).round(12))
    shares = in_shares(analysis, gains)
    with channel_picture(analysis, shares, _HEIGHT, each=2, sharex=True) as (figure, grid, found):
        for each in found:
            above, below = each.axes
            for axes in each.axes:
                for corner in corners:
                    axes.axvline(corner, color=MUTED, linewidth=0.5, linestyle=":")
            values = gains[:, each.row, each.column] * gain_factor(each.moved, each.output)
            sizes, style = np.abs(values), {"color": colours[each.output.name], "linewidth": 1.4}
            above.loglog(omegas, sizes, **style)
            above.set_ylim(bottom=max(sizes.min(), _FLOOR * sizes.max()) / 2.0)
            above.set_ylabel(gain_unit(each.moved, each.output) or "1")
            below.semilogx(omegas, np.degrees(np.unwrap(np.angle(values))), **style)
            below.yaxis.set_major_locator(_angles())
            below.set_ylabel("phase [°]")
            late = analysis.dead_times[each.row, each.column]
            if late > 0.0:
                below.text(0.02, 0.08, f"dead time {time_text(late)}", transform=below.transAxes)
        for column in grid.T:
            mark_frequencies(column)
    return figure


def _angles() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 1.8, 3, 4.5, 9, 10])
