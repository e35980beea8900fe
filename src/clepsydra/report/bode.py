"""Bode pictures: magnitude and phase of every channel, exact with dead time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.words import time_text
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.response import frequency_response
from clepsydra.report.colours import MUTED, signal_colours
from clepsydra.report.response_axes import (
    gain_factor,
    in_shares,
    mark_frequencies,
    picture,
    ratio_text,
    say_no_effect,
    shown_frequencies,
    title,
    without_effect,
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
    model, process = analysis.model, analysis.operating_point.process
    colours, omegas = signal_colours(process), shown_frequencies(analysis)
    gains = frequency_response(model, omegas)
    silent = without_effect(in_shares(analysis, gains))
    rows, columns = 2 * len(model.outputs), len(model.inputs)
    corners = np.unique(np.abs(analysis.poles[np.abs(analysis.poles) > 0.0]).round(12))
    with picture(rows, columns, _HEIGHT, sharex=True) as drawn:
        for place, output in enumerate(model.outputs):
            for column, name in enumerate(model.inputs):
                above, below = drawn.axes[2 * place : 2 * place + 2, column]
                signals = process.signal(output), process.signal(name)
                values = gains[:, place, column] * gain_factor(*signals)
                title(above, output, f"by {name}", columns)
                above.set_ylabel(ratio_text(*signals))
                below.set_ylabel("phase [°]")
                for axes in (above, below):
                    for corner in corners:
                        axes.axvline(corner, color=MUTED, linewidth=0.5, linestyle=":")
                if silent[place, column]:
                    for axes in (above, below):
                        say_no_effect(axes)
                    continue
                sizes = np.abs(values)
                style = {"color": colours[output], "linewidth": 1.4}
                above.loglog(omegas, sizes, **style)
                above.set_ylim(bottom=max(sizes.min(), _FLOOR * sizes.max()) / 2.0)
                phases = np.degrees(np.unwrap(np.angle(values)))
                below.semilogx(omegas, phases, **style)
                below.yaxis.set_major_locator(_angles())
                late = analysis.dead_times[place, column]
                if late > 0.0:
                    below.text(
                        0.02, 0.08, f"dead time {time_text(late)}", transform=below.transAxes
                    )
        for column in range(columns):
            mark_frequencies(drawn.axes[:, column])
    return drawn.figure


def _angles() -> object:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(4, steps=[1, 1.8, 3, 4.5, 9, 10])
