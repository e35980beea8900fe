"""Singular values, condition number and relative gains over frequency."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.linear.directionality import directionality
from clepsydra.report.colours import INK, MUTED, PALETTE
from clepsydra.report.response_axes import mark_frequencies, picture, shown_frequencies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEIGHT = 1.5
# A larger condition number is drawn as this.
_LARGEST = 1e6


def directionality_figure(analysis: Analysis) -> Figure:
    """Draw singular values in ranges, their ratio, and the relative gains, over frequency.

    Where a signal has no range only the relative gains are drawn. These are magnitudes; the
    suggested pairs are solid, the others dashed.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import clepsydra as cl
    >>> figure = directionality_figure(cl.load("quadruple-tank").analysis)
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['singular values [% per %]', 'condition number', '|relative gain|']
    """
    omegas = shown_frequencies(analysis)
    found = directionality(analysis.model, omegas)
    several = min(found.relative_gains.shape[1:]) > 1
    sizes, ratios = found.singular_values, found.condition_numbers if several else None
    gains = several or (sizes is None and ratios is None)
    rows = (sizes is not None) + (ratios is not None) + gains
    with picture(rows, 1, _HEIGHT, sharex=True) as (figure, grid):
        left = iter(grid[:, 0])
        if sizes is not None:
            axes = next(left)
            for place, values in enumerate(sizes.T):
                axes.loglog(omegas, values, color=MUTED if place else INK, linewidth=1.4)
            axes.axhline(1.0, color=MUTED, linewidth=0.6, linestyle=(0, (4, 3)))
            axes.set_ylabel("singular values [% per %]")
        if ratios is not None:
            axes = next(left)
            axes.loglog(omegas, np.minimum(ratios, _LARGEST), color=INK, linewidth=1.4)
            axes.set_ylabel("condition number")
            axes.set_ylim(bottom=1.0)
        if gains:
            _draw_relative_gains(next(left), omegas, found.relative_gains, analysis)
        mark_frequencies(grid[:, 0])
    return figure


def _draw_relative_gains(
    axes: Axes, omegas: np.ndarray, gains: np.ndarray, analysis: Analysis
) -> None:
    model = analysis.model
    # Relative gains of a square process come in equal pairs: those that coincide are one line.
    drawn: list[tuple[np.ndarray, list[str], bool]] = []
    for row, output in enumerate(model.outputs):
        for column, name in enumerate(model.inputs):
            sizes = np.abs(gains[:, row, column])
            chosen = (output, name) in analysis.pairing
            for known, names, solid in drawn:
                if solid == chosen and np.allclose(known, sizes, rtol=1e-3, equal_nan=True):
                    names.append(f"{output} by {name}")
                    break
            else:
                drawn.append((sizes, [f"{output} by {name}"], chosen))
    for (sizes, names, solid), colour in zip(drawn, cycle(PALETTE), strict=False):
        style = "-" if solid else (0, (4, 2.5))
        label = ", ".join(names)
        axes.semilogx(omegas, sizes, color=colour, linewidth=1.4, linestyle=style, label=label)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("|relative gain|")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
