"""Singular values, condition number and relative gains over frequency."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.linear.directionality import Directionality, directionality
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
    panels = [_draw_singular_values] if found.singular_values is not None else []
    if found.condition_numbers is not None and several:
        panels.append(_draw_condition)
    if several or not panels:
        panels.append(_draw_relative_gains)
    with picture(len(panels), 1, _HEIGHT, sharex=True) as (figure, grid):
        for axes, draw in zip(grid[:, 0], panels, strict=True):
            draw(axes, omegas, found, analysis)
        mark_frequencies(grid[:, 0])
    return figure


def _draw_singular_values(
    axes: Axes, omegas: np.ndarray, found: Directionality, analysis: Analysis
) -> None:
    assert found.singular_values is not None
    for place, values in enumerate(found.singular_values.T):
        axes.loglog(omegas, values, color=INK if place == 0 else MUTED, linewidth=1.4)
    axes.axhline(1.0, color=MUTED, linewidth=0.6, linestyle=(0, (4, 3)))
    axes.set_ylabel("singular values [% per %]")


def _draw_condition(
    axes: Axes, omegas: np.ndarray, found: Directionality, analysis: Analysis
) -> None:
    assert found.condition_numbers is not None
    axes.loglog(omegas, np.minimum(found.condition_numbers, _LARGEST), color=INK, linewidth=1.4)
    axes.set_ylabel("condition number")
    axes.set_ylim(bottom=1.0)


def _draw_relative_gains(
    axes: Axes, omegas: np.ndarray, found: Directionality, analysis: Analysis
) -> None:
    model = analysis.model
    # Relative gains of a square process come in equal pairs: those that coincide are one line.
    drawn: list[tuple[np.ndarray, list[str], bool]] = []
    for row, output in enumerate(model.outputs):
        for column, name in enumerate(model.inputs):
            sizes = np.abs(found.relative_gains[:, row, column])
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
