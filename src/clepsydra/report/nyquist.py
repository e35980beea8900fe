"""Nyquist pictures: every channel of a process in the complex plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.linear.response import frequency_response
from clepsydra.report.colours import INK, MUTED, signal_colours
from clepsydra.report.response_axes import (
    in_shares,
    picture,
    say_no_effect,
    shown_frequencies,
    title,
    without_effect,
)

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

    def response(frequencies: np.ndarray) -> np.ndarray:
        gains = frequency_response(model, frequencies)
        return in_shares(analysis, gains) if percent else gains

    gains = response(omegas)
    silent = without_effect(gains)
    rows, columns = len(model.outputs), len(model.inputs)
    decades = 10.0 ** np.arange(np.ceil(np.log10(omegas[0])), np.log10(omegas[-1]) + 1e-9)
    marked = response(decades) if len(decades) else gains[:0]
    with picture(rows, columns, min(2.6, 6.4 / columns)) as drawn:
        for place, output in enumerate(model.outputs):
            for column, name in enumerate(model.inputs):
                axes = drawn.axes[place, column]
                values, dots = gains[:, place, column], marked[:, place, column]
                title(axes, output, f"by {name}", columns)
                if place == rows - 1:
                    axes.set_xlabel("real part" + (" [% per %]" if percent else " [SI]"))
                if column == 0:
                    axes.set_ylabel("imaginary part")
                if silent[place, column]:
                    say_no_effect(axes)
                    axes.set_xticks([])
                    axes.set_box_aspect(1.0)
                    continue
                limit = _limit(values, bool(np.isinf(analysis.static_gain[place, column])))
                angle = np.linspace(0.0, 2.0 * np.pi, 200)
                circle = {"color": MUTED, "linewidth": 0.6, "linestyle": (0, (4, 3))}
                axes.plot(np.cos(angle), np.sin(angle), **circle)
                axes.plot([-1.0], [0.0], "+", color=INK, markersize=7)
                axes.plot(values.real, values.imag, color=colours[output], linewidth=1.4)
                axes.plot(dots.real, dots.imag, ".", color=colours[output], markersize=5)
                for omega, dot in zip(decades, dots, strict=True):
                    if 0.04 * limit < abs(dot) and max(abs(dot.real), abs(dot.imag)) < limit:
                        axes.annotate(
                            f"{omega:g}",
                            (dot.real, dot.imag),
                            xytext=(3, 3),
                            textcoords="offset points",
                            fontsize=6,
                            color=MUTED,
                        )
                axes.axhline(0.0, color=MUTED, linewidth=0.5)
                axes.axvline(0.0, color=MUTED, linewidth=0.5)
                axes.set_xlim(-limit, limit)
                axes.set_ylim(-limit, limit)
                axes.set_aspect("equal")
    return drawn.figure


def _limit(values: np.ndarray, integrates: bool) -> float:
    largest = float(np.abs(values).max(initial=0.0))
    return 1.1 * max(min(largest, _FARTHEST) if integrates else largest, 1.05)
