"""Measured against simulated, and the correlations of what is left, written as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.words import time_unit
from clepsydra.report.axes_box import draw_box, draw_legend
from clepsydra.report.chart import LETTER, SIZE, WIDTH, Chart, Scale, thinned
from clepsydra.report.colours import INK, MUTED, PALETTE
from clepsydra.report.quantities import display_factor, unit_text

_LEFT, _RIGHT, _LEGEND, _FOOTER, _GAP = 44.0, 10.0, 19.0, 28.0, 46.0
_OUTPUT, _INPUT, _CORRELATIONS = 150.0, 54.0, 92.0
_HELD = "#eef1f5"
#: Colour of what was measured; models take the palette.
_MEASURED = "#9aa4af"
_LAGS = 25


@dataclass(frozen=True, eq=False)
class ComparedSignal:
    """A signal of a record and what models say of it.

    Parameters
    ----------
    signal : Signal
    measured : ndarray [N]
        SI
    models : tuple of (name, ndarray [N])
        SI; none for an input, which is held between samples.

    Examples
    --------
    >>> ComparedSignal(Signal("pump", "V"), np.zeros(3)).models
    ()
    """

    signal: Signal
    measured: np.ndarray
    models: tuple[tuple[str, np.ndarray], ...] = ()


def comparison_svg(
    time: np.ndarray, held_back: int, signals: Sequence[ComparedSignal], title: str, prefix: str
) -> str:
    """Draw signals above each other over one time axis; the held-back part is shaded.

    Parameters
    ----------
    time : ndarray [N]
        [s]
    held_back : int
        First sample that no fit saw.
    signals : sequence of ComparedSignal
        Outputs first.
    title : str
        What it shows, for readers who do not see it.
    prefix : str
        Put before every identifier.

    Examples
    --------
    >>> level = ComparedSignal(Signal("level", "m"), np.zeros(9), (("FOPDT", np.zeros(9)),))
    >>> picture = comparison_svg(np.arange(9.0), 6, [level], "a level", "a")
    >>> picture.count(">FOPDT<"), picture.count(">held back<")
    (1, 1)
    """
    heights = [_OUTPUT if each.models else _INPUT for each in signals]
    chart = Chart(sum(heights) + _LEGEND * len(heights) + _FOOTER, title, prefix)
    unit, seconds = time_unit(float(time[-1] - time[0]))
    x = Scale(float(time[0]) / seconds, float(time[-1]) / seconds, _LEFT, WIDTH - _RIGHT)
    border = x.place(float(time[held_back]) / seconds)
    places = x.places(time / seconds)
    top = 0.0
    for number, (each, height) in enumerate(zip(signals, heights, strict=True)):
        top += _LEGEND
        last = number == len(signals) - 1
        _draw_signal(
            chart, each, x, (top, height), places, border, f"time [{unit}]" if last else ""
        )
        if not number:
            chart.text(x.end - 2.0, top + 9.0, "held back", anchor="end", colour=MUTED)
        top += height
    return chart.svg()


def _draw_signal(
    chart: Chart,
    each: ComparedSignal,
    x: Scale,
    room: tuple[float, float],
    places: np.ndarray,
    border: float,
    x_label: str,
) -> None:
    top, height = room
    factor = display_factor(each.signal)
    curves = [each.measured * factor]
    # A model that runs away would press everything else flat.
    size = max(float(np.ptp(curves[0])), 1e-3 * float(np.max(np.abs(curves[0]))), 1e-9)
    near = [
        values * factor
        for _, values in each.models
        if np.all(np.isfinite(values)) and np.max(np.abs(values * factor - curves[0])) < 2.0 * size
    ]
    low = min(float(np.min(values)) for values in (*curves, *near))
    high = max(float(np.max(values)) for values in (*curves, *near))
    margin = 0.06 * max(high - low, size)
    y = Scale(low - margin, high + margin, top + height, top)
    chart.box((border, x.end), (top, top + height), _HELD)
    draw_box(
        chart, x, y, x_label=x_label, y_label=unit_text(each.signal.shown_unit) or "–",
        x_numbers=bool(x_label), ticks=(8, 6 if height > 80.0 else 4),
    )  # fmt: skip
    clip = chart.clip((x.start, x.end), (top, top + height))
    measured = y.places(curves[0])
    if each.models:
        chart.curve(*thinned(places, measured), _MEASURED, 1.1, clip=clip)
    else:
        chart.curve(places, measured, INK, 1.1, held=True, clip=clip)
    entries = [(each.signal.name, _MEASURED if each.models else INK, 1.4, "")]
    for number, (name, values) in enumerate(each.models):
        colour, dash = PALETTE[number % len(PALETTE)], "" if number == 0 else "4 2.5"
        shown = y.places(np.where(np.isfinite(values), values * factor, np.nan))
        width = 1.3 if number == 0 else 0.9
        chart.curve(*thinned(places, shown), colour, width, dash=dash, clip=clip)
        entries.append((name, colour, 1.4, dash))
    draw_legend(chart, x.start, top - 4.5, entries, LETTER * SIZE)


def correlations_svg(
    residuals: np.ndarray, inputs: Sequence[tuple[str, np.ndarray]], prefix: str
) -> str:
    """Draw how residuals correlate with themselves and with inputs, samples apart.

    The band holds 95 of 100 correlations of white residuals that are free of the input.

    Parameters
    ----------
    residuals : ndarray [N]
    inputs : sequence of (name, ndarray [N])
        At most two are drawn.
    prefix : str
        Put before every identifier.

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal(99)
    >>> correlations_svg(noise, [("pump", np.sign(noise))], "a").count(">with pump, earlier<")
    1
    """
    pairs = [("with themselves", residuals)]
    pairs += [(f"with {name}, earlier", values) for name, values in list(inputs)[:2]]
    chart = Chart(_LEGEND + _CORRELATIONS + _FOOTER, "Correlations of the residuals", prefix)
    width = (WIDTH - _LEFT - _RIGHT - _GAP * (len(pairs) - 1)) / len(pairs)
    lags = np.arange(1, min(_LAGS, len(residuals) // 4) + 1)
    for number, (words, other) in enumerate(pairs):
        left = _LEFT + number * (width + _GAP)
        x = Scale(0.0, float(lags[-1]) + 1.0, left, left + width)
        y = Scale(-1.0, 1.0, _LEGEND + _CORRELATIONS, _LEGEND)
        band = 1.96 / np.sqrt(len(residuals))
        chart.box((x.start, x.end), (y.place(-band), y.place(band)), _HELD)
        draw_box(chart, x, y, x_label="samples apart", ticks=(5, 4))
        for lag, value in zip(lags, _correlations(residuals, other, lags), strict=True):
            place = x.place(float(lag))
            colour = PALETTE[1] if abs(value) > band else MUTED
            chart.line((place, place), (y.place(0.0), y.place(float(value))), colour, 2.0)
        chart.text(left, _LEGEND - 5.0, words, bold=True)
    return chart.svg()


def _correlations(residuals: np.ndarray, other: np.ndarray, lags: np.ndarray) -> np.ndarray:
    """Return the correlations of residuals with what another signal was some samples before."""
    one, two = residuals - np.mean(residuals), other - np.mean(other)
    size = float(np.linalg.norm(one) * np.linalg.norm(two))
    if size == 0.0:
        return np.zeros(len(lags))
    return np.array([one[lag:] @ two[: len(two) - lag] for lag in lags.tolist()]) / size
