"""The map of poles and zeros in the complex plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clepsydra.linear.analysis import Analysis
from clepsydra.report.colours import INK, LIMIT, MUTED
from clepsydra.report.response_axes import picture, power_of_ten

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEIGHT = 2.2
# Slow and fast roots are drawn together on an axis that is linear up to the slowest.
_SPREAD = 30.0


def roots_figure(analysis: Analysis) -> Figure:
    """Draw poles as crosses and zeros as circles; the right half-plane is shaded.

    Where rates differ by more than thirty times both axes are logarithmic away from the origin.

    Parameters
    ----------
    analysis : Analysis

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> import clepsydra as cl
    >>> figure = roots_figure(cl.load("quadruple-tank").analysis)
    >>> figure.axes[0].get_xlabel()
    'real part [rad/s]'
    """
    poles, zeros = analysis.poles, analysis.zeros
    roots = np.concatenate([poles, zeros])
    rates = np.abs(roots[np.abs(roots) > 0.0])
    slowest, fastest = (rates.min(), rates.max()) if rates.size else (1.0, 1.0)
    with picture(1, 1, _HEIGHT) as (figure, grid):
        axes = grid[0, 0]
        right = 1.25 * max(float(roots.real.max(initial=0.0)), 0.2 * fastest)
        left = 1.25 * min(float(roots.real.min(initial=0.0)), -0.2 * fastest)
        high = 1.25 * max(float(np.abs(roots.imag).max(initial=0.0)), 0.2 * fastest)
        if fastest > _SPREAD * slowest:
            axes.set_xscale("symlog", linthresh=slowest, linscale=0.7)
            axes.set_yscale("symlog", linthresh=slowest, linscale=0.7)
            axes.xaxis.set_major_formatter(power_of_ten)
            axes.yaxis.set_major_formatter(power_of_ten)
        axes.axvspan(0.0, right, facecolor=LIMIT, alpha=0.6, lw=0)
        axes.axhline(0.0, color=MUTED, linewidth=0.6)
        axes.axvline(0.0, color=MUTED, linewidth=0.6)
        cross = {"marker": "x", "color": INK, "markersize": 7, "markeredgewidth": 1.4}
        axes.plot(poles.real, poles.imag, linestyle="none", label="pole", **cross)
        if zeros.size:
            circle = {"marker": "o", "color": "#D55E00", "markersize": 7, "markeredgewidth": 1.4}
            axes.plot(
                zeros.real, zeros.imag, linestyle="none", fillstyle="none", label="zero", **circle
            )
        axes.set(xlim=(left, right), xlabel="real part [rad/s]")
        axes.set(ylim=(-high, high), ylabel="imaginary part [rad/s]")
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    return figure
