"""Measured against simulated, and the correlations of what is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.signal import Signal
from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.report.colours import INK, MUTED, PALETTE
from clepsydra.report.quantities import (
    display_factor,
)
from clepsydra.report.response_axes import picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Heights of a row [inch].
_OUTPUT, _INPUT, _CORRELATIONS = 2.3, 1.0, 1.3
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
    """

    signal: Signal
    measured: np.ndarray
    models: tuple[tuple[str, np.ndarray], ...] = ()


def comparison_figure(
    time: np.ndarray, held_back: int, signals: Sequence[ComparedSignal]
) -> Figure:
    """Draw signals above each other over one time axis; the held-back part is shaded.

    Parameters
    ----------
    time : ndarray [N]
        [s]
    held_back : int
        First sample that no fit saw.
    signals : sequence of ComparedSignal
        Outputs first.
    """
    heights = [_OUTPUT if each.models else _INPUT for each in signals]
    unit, seconds = time_unit(float(time[-1] - time[0]))
    shown, share = time / seconds, {"height_ratios": heights}
    size = len(heights), 1, sum(heights) / len(heights)
    with picture(*size, sharex=True, gridspec_kw=share) as (figure, grid):
        rows = grid[:, 0]
        for axes, each in zip(rows, signals, strict=True):
            axes.axvspan(float(shown[held_back]), float(shown[-1]), color=_HELD, lw=0)
            _draw_signal(axes, each, shown)
        rows[0].annotate(
            "held back", (1.0, 1.0), (-3.0, -3.0), "axes fraction", "offset points",
            ha="right", va="top", color=MUTED,
        )  # fmt: skip
        rows[-1].set_xlabel(f"time [{unit}]")
        rows[-1].set_xlim(float(shown[0]), float(shown[-1]))
    return figure


def _draw_signal(axes: Axes, each: ComparedSignal, time: np.ndarray) -> None:
    factor = display_factor(each.signal)
    measured = each.measured * factor
    # A model that runs away would press everything else flat.
    size = max(float(np.ptp(measured)), 1e-3 * float(np.max(np.abs(measured))), 1e-9)
    near = [
        values * factor
        for _, values in each.models
        if np.all(np.isfinite(values)) and np.max(np.abs(values * factor - measured)) < 2.0 * size
    ]
    low = min(float(np.min(values)) for values in (measured, *near))
    high = max(float(np.max(values)) for values in (measured, *near))
    margin = 0.06 * max(high - low, size)
    colour, steps = (_MEASURED, "default") if each.models else (INK, "steps-post")
    axes.plot(time, measured, color=colour, linewidth=1.1, label=each.signal.name, drawstyle=steps)
    for number, (name, values) in enumerate(each.models):
        axes.plot(
            time, np.where(np.isfinite(values), values * factor, np.nan), label=name,
            color=PALETTE[number % len(PALETTE)], linewidth=0.9 if number else 1.3,
            linestyle="--" if number else "-",
        )  # fmt: skip
    axes.set_ylim(low - margin, high + margin)
    axes.set_ylabel(unit_text(each.signal.shown_unit) or "–")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 0.98), ncols=1 + len(each.models))


def correlations_figure(residuals: np.ndarray, inputs: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """Draw how residuals correlate with themselves and with inputs, samples apart.

    The band holds 95 of 100 correlations of white residuals that are free of the input.

    Parameters
    ----------
    residuals : ndarray [N]
    inputs : sequence of (name, ndarray [N])
        At most two are drawn.
    """
    pairs = [("with themselves", residuals)]
    pairs += [(f"with {name}, earlier", values) for name, values in list(inputs)[:2]]
    lags = np.arange(1, min(_LAGS, len(residuals) // 4) + 1)
    band = 1.96 / np.sqrt(len(residuals))
    with picture(1, len(pairs), _CORRELATIONS, sharey=True) as (figure, grid):
        for axes, (words, other) in zip(grid[0], pairs, strict=True):
            values = _correlations(residuals, other, lags)
            colours = [PALETTE[1] if abs(value) > band else MUTED for value in values]
            axes.axhspan(-band, band, color=_HELD, lw=0)
            axes.vlines(lags, 0.0, values, colors=colours, linewidths=2.0)
            axes.set(xlim=(0.0, float(lags[-1]) + 1.0), ylim=(-1.0, 1.0), xlabel="samples apart")
            axes.set_title(words, loc="left")
    return figure


def _correlations(residuals: np.ndarray, other: np.ndarray, lags: np.ndarray) -> np.ndarray:
    """Return the correlations of residuals with what another signal was some samples before."""
    one, two = residuals - np.mean(residuals), other - np.mean(other)
    size = float(np.linalg.norm(one) * np.linalg.norm(two))
    if size == 0.0:
        return np.zeros(len(lags))
    return np.correlate(one, two, "full")[len(one) - 1 + lags] / size
