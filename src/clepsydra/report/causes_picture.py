"""From which parameters the scatter of the error comes, as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clepsydra.report.colours import INK, PALETTE
from clepsydra.report.quantities import fitted
from clepsydra.report.response_axes import picture
from clepsydra.studies.robustness.sensitivity import Sensitivity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Bars at most, the height of one [inch], and letters of a name.
_BARS, _HEIGHT, _LETTERS = 12, 0.2, 44


def causes_figure(found: Sensitivity) -> Figure:
    """Draw the total index of each group of parameters with its interval, the largest on top.

    A mark in the bar is the index of first order.

    Parameters
    ----------
    found : Sensitivity
        Known.

    Returns
    -------
    matplotlib.figure.Figure
        Without pyplot.

    Examples
    --------
    >>> from clepsydra.studies.robustness.sensitivity import SobolIndex
    >>> area, pump = SobolIndex(0.3, 0.25, 0.35), SobolIndex(0.7, 0.6, 0.8)
    >>> both = {"area": area, "pump": pump}
    >>> (axes,) = causes_figure(Sensitivity(both, both, 512, 0, True)).axes
    >>> [label.get_text() for label in axes.get_yticklabels()]
    ['pump', 'area']
    """
    names = sorted(found.total, key=lambda name: -found.total[name].value)[:_BARS]
    places = range(len(names))
    total, first = (
        [100.0 * each[name].value for name in names] for each in (found.total, found.first)
    )
    intervals = [found.total[name] for name in names]
    beside = [
        [max(value - 100.0 * each.low, 0.0) for value, each in zip(total, intervals, strict=True)],
        [max(100.0 * each.high - value, 0.0) for value, each in zip(total, intervals, strict=True)],
    ]
    with picture(1, 1, _HEIGHT * len(names) + 0.1) as (figure, grid):
        axes = grid[0, 0]
        axes.barh(
            places, total, 0.62, color=PALETTE[0], alpha=0.45, label="with all that it acts with"
        )
        axes.errorbar(
            total, places, xerr=beside, fmt="none", ecolor=INK, elinewidth=0.9, capsize=2.0,
            label="interval of that",
        )  # fmt: skip
        axes.scatter(first, places, marker="D", s=16.0, color=PALETTE[1], zorder=3.0, label="alone")
        axes.set_yticks(list(places), [fitted(name, _LETTERS) for name in names])
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_xlim(min(0.0, *first), None)
        axes.set_xlabel("share of the scatter of the error [%]")
        axes.grid(visible=False, axis="y")
        figure.legend(loc="outside upper left", ncols=3)
    return figure
