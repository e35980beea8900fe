"""What a run shows that its reader must know."""

from __future__ import annotations

import numpy as np

from clepsydra.base.units import from_si
from clepsydra.loop.run import Run
from clepsydra.scores.effort import at_limit

#: Share of the run in saturation above which the reader is told.
_SATURATED = 0.05
#: Error estimate above which the reader is told, share of the state's range.
_ERROR = 1e-6


def run_warnings(run: Run) -> tuple[str, ...]:
    """Return what is unusual about a run: overflow, empty tanks, saturation, a large error."""
    return (*_levels(run), *_saturation(run), *_accuracy(run))


def leaves_its_tanks(run: Run) -> bool:
    """Return whether a state leaves its range or stops being a number."""
    return any(
        not np.all((run.values[x.name] >= x.low) & (run.values[x.name] <= x.high))
        for x in run.process.state
    )


def _levels(run: Run) -> list[str]:
    words = []
    for x in run.process.state:
        level = run.values[x.name]
        limits = (
            (level > x.high, "rises above its rim", "the model spills nothing"),
            (level <= x.low, "runs empty", "its outlet has no flow then"),
            (np.isnan(level), "is not a number", "the loop has diverged"),
        )
        for where, what, consequence in limits:
            if np.any(where):
                time = run.time[int(np.argmax(where))]
                high = from_si(x.high, x.unit, x.shown_unit)
                words.append(
                    f"{x.name} {what} at {time:g} s (range 0 to {high:g} {x.shown_unit}); "
                    f"{consequence}."
                )
    return words


def _saturation(run: Run) -> list[str]:
    words = []
    for u in run.process.inputs:
        share = float(np.mean(at_limit(run.values[u.name], u.low, u.high)))
        if share > _SATURATED:
            words.append(f"{u.name} stands at a limit for {100 * share:.0f} % of the time.")
    return words


def _accuracy(run: Run) -> list[str]:
    if run.error_estimate is None or run.error_estimate <= _ERROR:
        return []
    return [
        f"Halving the integration step still changes a state by {run.error_estimate:.1e} of its "
        "range: near an empty tank the flow is not smooth."
    ]
