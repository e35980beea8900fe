"""What the pictures of a linear model share: frequencies, units, and a grid of small axes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import SUPERSCRIPTS
from clepsydra.linear.analysis import Analysis
from clepsydra.linear.frequency_grid import frequency_grid
from clepsydra.report.colours import MUTED
from clepsydra.report.quantities import fitted
from clepsydra.report.trends import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Width of a picture [inch], that of the trends.
WIDTH = 7.4
# A picture shows this many times beyond the slowest and the fastest of the process.
_BEYOND = 30.0
# And not more than this many turns of the phase by the longest dead time.
_TURNS = 2.0
_LETTERS_AN_INCH = 13
# A channel below this share of the strongest, both in ranges, is rounding.
_ROUNDING = 1e-12


def shown_frequencies(analysis: Analysis) -> np.ndarray:
    """Return the frequencies of a picture [rad/s], rising, none of them a pole.

    Examples
    --------
    >>> import clepsydra as cl
    >>> omegas = shown_frequencies(cl.load("quadruple-tank").analysis)
    >>> omegas[0] < 0.011 / 20, omegas[-1] > 20 * 0.0597  # the slowest pole, the fastest zero
    (np.True_, np.True_)
    """
    grid = frequency_grid(analysis.model)
    roots = np.concatenate([analysis.poles, analysis.zeros])
    rates = np.abs(roots[np.abs(roots) > 0.0])
    delays = analysis.model.delays
    if delays is not None:
        rates = np.append(rates, 1.0 / delays.times)
    if not rates.size:
        return grid
    low, high = rates.min() / _BEYOND, rates.max() * _BEYOND
    if delays is not None:
        high = min(high, max(2.0 * np.pi * _TURNS / delays.times.max(), 3.0 * rates.min()))
    chosen: np.ndarray = grid[(grid >= low) & (grid <= high)]
    return chosen


def in_shares(analysis: Analysis, gains: np.ndarray) -> np.ndarray:
    """Return responses [l, q, m] in SI in % per %; of a signal without a range in its unit."""
    model, process = analysis.model, analysis.operating_point.process
    spans = [
        np.array(
            [s.percent_span if np.isfinite(s.span) else 1.0 for s in map(process.signal, names)]
        )
        for names in (model.outputs, model.inputs)
    ]
    return np.asarray(gains / spans[0][:, None] * spans[1])


def power_of_ten(value: float, _: object = None) -> str:
    """Return a tick of a logarithmic axis with either sign as text.

    >>> power_of_ten(-0.01), power_of_ten(0.0), power_of_ten(1.0)
    ('−10⁻²', '0', '10⁰')
    """
    if value == 0.0:
        return "0"
    exponent = str(round(np.log10(abs(value)))).translate(SUPERSCRIPTS)
    return f"{'−' if value < 0.0 else ''}10{exponent}"


@dataclass(frozen=True, eq=False)
class Channel:
    """What one manipulated variable does to one output, and the axes that show it.

    Parameters
    ----------
    output, moved : Signal
    row, column : int
        Of the output and of what is moved, in the linear model.
    axes : tuple of matplotlib.axes.Axes
        Above each other.
    """

    output: Signal
    moved: Signal
    row: int
    column: int
    axes: tuple[Axes, ...]


@contextmanager
def picture(
    rows: int, columns: int, height: float, **options: Any
) -> Iterator[tuple[Figure, np.ndarray]]:
    """Give a figure with a grid of axes [rows, columns], each row of a height [inch]."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, rows * height + 0.75), layout="constrained")
        yield figure, figure.subplots(rows, columns, squeeze=False, **options)


@contextmanager
def channel_picture(
    analysis: Analysis,
    shares: np.ndarray,
    height: float,
    *,
    each: int = 1,
    cause: Callable[[Signal], str] = lambda moved: f"by {moved.name}",
    **options: Any,
) -> Iterator[tuple[Figure, np.ndarray, list[Channel]]]:
    """Give a figure with axes from each input (columns) to each output (rows), titled.

    Channels that are nothing but rounding beside the strongest say so, and are not given.

    Parameters
    ----------
    shares : ndarray [points, outputs, inputs]
        What is drawn, in ranges.
    height : float
        Of a row [inch].
    each : int
        Rows to an output.
    cause : callable
        What is done, of what is moved.
    **options
        Of Matplotlib's ``subplots``.
    """
    model, process = analysis.model, analysis.operating_point.process
    largest = np.abs(shares).max(axis=0)
    silent = largest <= _ROUNDING * largest.max(initial=0.0)
    found, columns = [], len(model.inputs)
    with picture(each * len(model.outputs), columns, height, **options) as (figure, grid):
        for row, output in enumerate(map(process.signal, model.outputs)):
            for column, moved in enumerate(map(process.signal, model.inputs)):
                own = tuple(grid[each * row : each * (row + 1), column])
                title(own[0], output.name, cause(moved), columns)
                if silent[row, column]:
                    for axes in own:
                        axes.text(0.5, 0.5, "no effect", transform=axes.transAxes, ha="center")
                        axes.set_yticks([])
                else:
                    found.append(Channel(output, moved, row, column, own))
        yield figure, grid, found


def title(axes: Axes, output: str, cause: str, columns: int) -> None:
    """Write what axes show above them: in two lines, each shortened, where one is too narrow."""
    letters = max(int(WIDTH / columns * _LETTERS_AN_INCH) - 8, 12)
    words = f"{output} {cause}"
    if len(words) > letters:
        words = "\n".join(fitted(line, letters) for line in (output, cause))
    axes.set_title(words, loc="left", fontsize=7.5)


def mark_frequencies(axes: Sequence[Axes] | np.ndarray) -> None:
    """Give axes a logarithmic frequency axis, named below the last of them."""
    for entry in axes:
        entry.set_xscale("log")
        entry.tick_params(which="minor", color=MUTED)
    axes[-1].set_xlabel("frequency [rad/s]")
