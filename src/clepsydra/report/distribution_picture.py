"""How the error is distributed over the plants: the share of them that stays below each."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.report.colours import INK, MUTED, PALETTE
from clepsydra.report.quantities import number_text
from clepsydra.report.response_axes import picture
from clepsydra.studies.robustness.distribution import Distribution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Height [inch], points of the curve at most, and the quantiles that are marked.
_HEIGHT, _POINTS, _MARKED = 1.9, 400, (0.5, 0.95, 0.99)
#: A worst plant this many times as far from the median as the farthest quantile is told in words,
#: since it would press the curve flat.
_FAR, _MARGIN = 2.0, 0.06
#: On each side, where the plants hardly differ.
_LEAST = 0.01


def distribution_figure(found: Distribution) -> Figure:
    """Draw the empirical distribution of the error, as a multiple of what it is on paper.

    Parameters
    ----------
    found : Distribution
        Infinite where a loop broke.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot.

    Examples
    --------
    >>> (axes,) = distribution_figure(Distribution.of(np.linspace(0.9, 1.2, 500))).axes
    >>> axes.get_xlabel()
    'error as a multiple of that on paper'
    """
    places = np.unique(np.linspace(1, found.count, _POINTS).round().astype(int))
    values = np.array([found.at(int(place)) for place in places])
    quantiles = [found.quantile(chance) for chance in _MARKED]
    finite = values[np.isfinite(values)]
    with picture(1, 1, _HEIGHT) as (figure, grid):
        axes = grid[0, 0]
        axes.axvline(1.0, color=INK, linewidth=0.9, label="on paper")
        shares = 100.0 * places[: len(finite)] / found.count
        axes.plot(
            finite, shares, color=PALETTE[0], linewidth=1.4, drawstyle="steps-post",
            label="plants at or below",
        )  # fmt: skip
        marked = [each for each in quantiles if math.isfinite(each.value)]
        for place, each in enumerate(marked):
            height, high = 100.0 * each.chance, each.high
            ends = [each.value if e is None or math.isinf(e) else e for e in (each.low, high)]
            axes.plot(
                ends, [height, height], color=PALETTE[1], linewidth=3.0, alpha=0.45,
                solid_capstyle="butt", label="" if place else "interval of a quantile",
            )  # fmt: skip
            axes.plot(each.value, height, marker="o", markersize=3.5, color=PALETTE[1])
            axes.annotate(
                f"{height:g} %: {number_text(each.value)}", (each.value, height),
                (6.0, 3.0 if each is quantiles[-1] else -9.0),
                textcoords="offset points", color=INK, fontsize=7.0,
            )  # fmt: skip
        low, high, words = _view(found, finite, [each.value for each in marked])
        axes.set_xlim(low, high)
        axes.set_ylim(0.0, 112.0)
        axes.set_yticks(range(0, 101, 20))
        axes.set_xlabel("error as a multiple of that on paper")
        axes.set_ylabel("share of plants [%]")
        if words:
            axes.text(
                0.995, 0.04, words, transform=axes.transAxes, ha="right", va="bottom", color=MUTED
            )
        figure.legend(loc="outside upper left", ncols=3)
    return figure


def _view(found: Distribution, finite: np.ndarray, marked: list[float]) -> tuple[float, float, str]:
    """Return the ends of the axis, and what is said of what lies beyond."""
    worst = found.extremes.worst()
    low, last = (float(finite[0]), float(finite[-1])) if finite.size else (1.0, 1.0)
    words = f"worst: draw {worst.draw}, {number_text(worst.value)}"
    high = last
    if marked:
        middle, far = marked[0], marked[-1]
        reach = middle + _FAR * max(far - middle, middle - low)
        high = min(high, reach)
    low, high = min(low, 1.0), max(high, 1.0)
    margin = max(_MARGIN * (high - low), _LEAST)
    return low - margin, high + margin, words + (" →" if worst.value > high + margin else "")
