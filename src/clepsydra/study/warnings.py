"""What a run shows that its reader must know."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from clepsydra.base.units import from_si
from clepsydra.loop.lane_status import EMPTY_SHARE
from clepsydra.loop.run import Run
from clepsydra.scores.effort import at_limit

#: Share of the run in saturation above which the reader is told.
_SATURATED = 0.05
#: Error estimate above which the reader is told, share of the state's range.
_ERROR = 1e-6


def run_warnings(run: Run) -> tuple[str, ...]:
    """Return what is unusual about a run: overflow, empty tanks, saturation, a large error."""
    return (*_levels(run), *_saturation(run), *_accuracy(run))


def settling_warnings(scores: Mapping[str, float]) -> tuple[str, ...]:
    """Return which controlled variables are not at rest at the end of their setpoint steps.

    Examples
    --------
    >>> settling_warnings({"settling_time[level_1]": math.inf, "iae[level_1]": 2.0})
    ('level_1 does not settle within its setpoint step.',)
    """
    return tuple(
        f"{name.removeprefix('settling_time[').removesuffix(']')} does not settle within its "
        "setpoint step."
        for name, time in scores.items()
        if name.startswith("settling_time[") and math.isinf(time)
    )


def leaves_its_tanks(run: Run) -> bool:
    """Return whether a level leaves its tank or a state stops being a number."""
    process = run.process
    within = all(
        np.all((run.values[x.name] >= x.low) & (run.values[x.name] <= x.high))
        for x in process.state
        if x.name in process.levels
    )
    return not within or any(not np.all(np.isfinite(run.values[x.name])) for x in process.state)


def _levels(run: Run) -> list[str]:
    words = []
    totals = {total.name for total in run.process.motion.totals}
    for x in run.process.state:
        level = run.values[x.name]
        limits = [(np.isnan(level), "is not a number", "the loop has diverged")]
        if x.name in run.process.levels:
            spills = f"{x.name.removesuffix('level')}spilt" in totals
            lost = "it spills" if spills else "the model spills nothing, since it has no weir"
            empty = level <= x.low + EMPTY_SHARE * (x.high - x.low)
            limits.append((level > x.high, "rises above its rim", lost))
            limits.append((empty, "runs empty", "what is drawn from it breaks off"))
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
