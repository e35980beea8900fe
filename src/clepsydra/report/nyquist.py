"""Nyquist pictures: every channel of a process in the complex plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.linear.response import frequency_response
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.response_axes import channel_picture, in_shares, shown_frequencies

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The view of a channel that integrates ends at this gain.
_FARTHEST = 3.0


def nyquist_figure(analysis: Analysis) -> Figure:
    """Draw g(jω) from each input (columns) to each output (rows) for ω above zero.

    Gains are in % per %, so that the unit circle (dashed) and the cross at -1 mean a proportional
    controller of gain 1 %/%; dots mark the decades of the frequency. Without ranges they are in
    SI.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import clepsydra as cl
    >>> len(nyquist_figure(cl.load("quadruple-tank").analysis).axes)
    4
    """
    model, process = analysis.model, analysis.operating_point.process
    signals = [process.signal(name) for name in (*model.outputs, *model.inputs)]
    percent = all(signal.has_range for signal in signals)
    colours = signal_colours(process)
    omegas = shown_frequencies(analysis)
    decades = 10.0 ** np.arange(np.ceil(np.log10(omegas[0])), np.log10(omegas[-1]) + 1e-9)
    count, height = len(omegas), min(2.6, 6.4 / len(model.inputs))
    gains = frequency_response(model, np.concatenate([omegas, decades]))
    gains = in_shares(analysis, gains) if percent else gains
    with channel_picture(analysis, gains[:count], height) as (figure, grid, found):
        for each in found:
            (axes,) = each.axes
            values, dots = np.split(gains[:, each.row, each.column], [count])
            limit = _limit(values, bool(np.isinf(analysis.static_gain[each.row, each.column])))
            angle = np.linspace(0.0, 2.0 * np.pi, 200)
            axes.plot(
                np.cos(angle), np.sin(angle), color=MUTED, linewidth=0.6, linestyle=(0, (4, 3))
            )
            axes.plot([-1.0], [0.0], "+", color=INK, markersize=7)
            colour = colours[each.output.name]
            axes.plot(values.real, values.imag, color=colour, linewidth=1.4)
            axes.plot(dots.real, dots.imag, ".", color=colour, markersize=5)
            for omega, dot in zip(decades, dots, strict=True):
                if 0.04 * limit < abs(dot) and max(abs(dot.real), abs(dot.imag)) < limit:
                    axes.annotate(
                        f"{omega:g}", (dot.real, dot.imag), (3, 3), textcoords="offset points",
                        fontsize=6, color=MUTED,
                    )  # fmt: skip
            axes.axhline(0.0, color=MUTED, linewidth=0.5)
            axes.axvline(0.0, color=MUTED, linewidth=0.5)
            axes.set(xlim=(-limit, limit), ylim=(-limit, limit))
        for axes in grid.flat:
            axes.set_box_aspect(1.0)
            if not axes.lines:
                axes.set_xticks([])
        for axes in grid[-1]:
            axes.set_xlabel("real part" + (" [% per %]" if percent else " [SI]"))
        for axes in grid[:, 0]:
            axes.set_ylabel("imaginary part")
    return figure


def _limit(values: np.ndarray, integrates: bool) -> float:
    largest = float(np.abs(values).max(initial=0.0))
    return 1.1 * max(min(largest, _FARTHEST) if integrates else largest, 1.05)
