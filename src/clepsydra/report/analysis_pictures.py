"""Bode pictures: magnitude and phase of every channel, exact with dead time."""

from __future__ import annotations

import math
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_text, time_unit
from clepsydra.designs.gain_units import gain_factor
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.dead_time import without_dead_time
from clepsydra.linear.directionality import directionality
from clepsydra.linear.response import frequency_response
from clepsydra.linear.roots import PADE_ORDER
from clepsydra.linear.step_response import step_response
from clepsydra.report.colours import INK, LIMIT, MUTED, PALETTE, signal_colours
from clepsydra.report.facts import gain_unit
from clepsydra.report.quantities import (
    display_factor,
    short_text,
)
from clepsydra.report.response_axes import (
    channel_picture,
    in_shares,
    mark_frequencies,
    picture,
    power_of_ten,
    shown_frequencies,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# Magnitudes are shown over this share of the largest.
_FLOOR = 1e-6
_BODE_HEIGHT = 1.05


def bode_figure(analysis: Analysis) -> Figure:
    """Draw magnitude and phase from each input (columns) to each output (rows).

    Magnitudes are in display units of output per input, phases continuous in degrees; the
    line has the colour of the output, dotted lines stand at the poles' frequencies.
    """
    omegas = shown_frequencies(analysis)
    gains = frequency_response(analysis.model, omegas)
    colours = signal_colours(analysis.operating_point.process)
    corners = np.unique(np.abs(analysis.poles[np.abs(analysis.poles) > 0.0]).round(12))
    shares = in_shares(analysis, gains)
    with channel_picture(analysis, shares, _BODE_HEIGHT, each=2, sharex=True) as (
        figure,
        grid,
        found,
    ):
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
            below.locator_params(axis="y", nbins=4, steps=[1, 1.8, 3, 4.5, 9, 10])
            below.set_ylabel("phase [°]")
            late = analysis.dead_times[each.row, each.column]
            if late > 0.0:
                below.text(0.02, 0.08, f"dead time {time_text(late)}", transform=below.transAxes)
        for column in grid.T:
            mark_frequencies(column)
    return figure


# The view of a channel that integrates ends at this gain.
_FARTHEST = 3.0


def nyquist_figure(analysis: Analysis) -> Figure:
    """Draw g(jω) from each input (columns) to each output (rows) for ω above zero.

    Gains are in % per %, so that the unit circle (dashed) and the cross at -1 mean a proportional
    controller of gain 1 %/%; dots mark the decades of the frequency. Without ranges they are in
    SI.
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


_ROOTS_HEIGHT = 2.2
# Slow and fast roots are drawn together on an axis that is linear up to the slowest.
_SPREAD = 30.0


def roots_figure(analysis: Analysis) -> Figure:
    """Draw poles as crosses and zeros as circles; the right half-plane is shaded.

    Where rates differ by more than thirty times both axes are logarithmic away from the origin.

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
    with picture(1, 1, _ROOTS_HEIGHT) as (figure, grid):
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
        style: dict[str, Any] = {"linestyle": "none", "markersize": 7, "markeredgewidth": 1.4}
        axes.plot(poles.real, poles.imag, marker="x", color=INK, label="pole", **style)
        if zeros.size:
            style |= {"marker": "o", "color": "#D55E00", "fillstyle": "none"}
            axes.plot(zeros.real, zeros.imag, label="zero", **style)
        axes.set(xlim=(left, right), xlabel="real part [rad/s]")
        axes.set(ylim=(-high, high), ylabel="imaginary part [rad/s]")
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    return figure


_ROW_HEIGHT = 1.5
# A larger condition number is drawn as this.
_LARGEST = 1e6


def directionality_figure(analysis: Analysis) -> Figure:
    """Draw singular values in ranges, their ratio, and the relative gains, over frequency.

    Where a signal has no range only the relative gains are drawn. These are magnitudes; the
    suggested pairs are solid, the others dashed.
    """
    omegas = shown_frequencies(analysis)
    found = directionality(analysis.model, omegas)
    several = min(found.relative_gains.shape[1:]) > 1
    sizes, ratios = found.singular_values, found.condition_numbers if several else None
    gains = several or (sizes is None and ratios is None)
    rows = (sizes is not None) + (ratios is not None) + gains
    with picture(rows, 1, _ROW_HEIGHT, sharex=True) as (figure, grid):
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


#: The step of an input with a range, a share of it.
STEP = 0.1
_POINTS = 400
_SLOWEST_TIMES = 5.0
# A dead time below this share of the axis is drawn again, larger, as far as this many of it.
_HARDLY_SEEN = 0.1
_START = 4.0
_STEP_HEIGHT = 1.25


def step_figure(analysis: Analysis) -> Figure:
    """Draw what each output (rows) does after a step of each input (columns), from rest.

    A step is a tenth of the input's range, or one of its display units; outputs are deviations
    in display units. A dotted line stands at the end of the dead time.

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
    with channel_picture(analysis, shares, _STEP_HEIGHT, cause=_step_words, sharex=True) as drawn:
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
