"""The first events of a study as a still picture: what a page shows where no script runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.units import unit_text
from clepsydra.base.words import time_unit
from clepsydra.report.colours import INK, MUTED, PALETTE
from clepsydra.report.overlay import EventWindow, ShownSignal, event_title, shown_span
from clepsydra.report.trends import STYLE
from clepsydra.studies.result import Candidate

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Columns, levels and manipulated variables at most; width, height of a row and around [inch].
_COLUMNS, _HELD, _MOVED = 3, 2, 1
_WIDTH, _ROW, _AROUND = 9.6, 1.05, 0.7
#: A signal spans at least so much of its axis as beside the one of its kind that moves most.
_LEAST = 0.3


def overlay_figure(
    windows: Sequence[EventWindow], signals: Sequence[ShownSignal], first: Sequence[Candidate]
) -> Figure:
    """Draw the first events in columns, and in rows what each controller makes of them.

    Parameters
    ----------
    first : sequence of Candidate
        In the order of their colours.
    """
    import matplotlib
    from matplotlib.figure import Figure

    columns = [window for window in windows if not window.again][:_COLUMNS]
    chosen = [each for each in signals if not each.moved][:_HELD]
    chosen += [each for each in signals if each.moved][:_MOVED]
    rows = [each for each in signals if each in chosen]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(_WIDTH, _AROUND + _ROW * len(rows)))
        height = figure.get_figheight()
        figure.subplots_adjust(
            left=0.08, right=0.99, top=1.0 - 0.3 / height, bottom=0.65 / height,
            wspace=0.16, hspace=0.3,
        )  # fmt: skip
        grid = figure.subplots(len(rows), max(1, len(columns)), squeeze=False, sharex="col")
        for column, window in enumerate(columns):
            run = first[0].run
            start, period = window.segment.start, run.scenario.sampling_period
            unit, length = time_unit(window.view[1])
            time = (window.samples * period - start) / length
            seen = time <= window.view[1] / length
            for row, shown in enumerate(rows):
                axes = grid[row, column]
                wanted = shown.setpoint(run)
                if wanted is not None:
                    axes.plot(
                        time[seen], wanted[window.samples][seen], color=MUTED, linewidth=0.8,
                        linestyle="--", drawstyle="steps-post",
                    )  # fmt: skip
                for place, each in enumerate(first):
                    values = shown.values(each.run)[window.samples]
                    axes.plot(
                        time[seen], np.where(np.isfinite(values), values, np.nan)[seen],
                        color=PALETTE[place], linewidth=1.2, label=each.controller.title,
                        drawstyle="steps-post" if shown.moved else "default",
                    )  # fmt: skip
                for end in shown.band(run.process) or ():
                    axes.axhline(end, color=INK, linewidth=0.8)
                if not column:
                    unit_words = unit_text(shown.signal.shown_unit) or "1"
                    axes.set_ylabel(f"{shown.name}\n[{unit_words}]")
                axes.margins(x=0.0)
                axes.locator_params(nbins=3)
            _widen(grid[:, column], rows)
            grid[0, column].set_title(event_title(run.process, window.segment), loc="left")
            grid[-1, column].set_xlabel(f"time after the event [{unit}]")
        figure.align_ylabels(grid[:, 0])
        names, lines = grid[0, 0].get_legend_handles_labels()
        figure.legend(names, lines, loc="lower left", ncols=len(first))
    return figure


def _widen(column: np.ndarray, rows: Sequence[ShownSignal]) -> None:
    """Let what looks like motion be motion: no axis is fine beside those of the same kind."""
    for moved in (False, True):
        own = [(axes, row) for axes, row in zip(column, rows, strict=True) if row.moved is moved]
        shares = [np.ptp(axes.get_ylim()) / shown_span(row.signal) for axes, row in own]
        for (axes, row), share in zip(own, shares, strict=True):
            more = (_LEAST * max(shares) - share) * shown_span(row.signal) / 2.0
            if more > 0.0:
                bottom, top = axes.get_ylim()
                axes.set_ylim(bottom - more, top + more)
