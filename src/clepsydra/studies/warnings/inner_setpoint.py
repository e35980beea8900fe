"""The warning of a cascade whose inner setpoint stands at a limit."""

from __future__ import annotations

from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.run import Run
from clepsydra.studies.warnings.saturation import MOSTLY, share_at_limit
from clepsydra.studies.warnings.words import shown


def inner_setpoint_warnings(run: Run) -> list[str]:
    """Return warnings of inner setpoints that stand at a limit for more than half of a run."""
    words = []
    for inner in inner_setpoints(run.controller, run.process):
        share, mostly_low = share_at_limit(run.values[inner.name], inner.low, inner.high)
        if share > MOSTLY:
            end, limit = ("low", inner.low) if mostly_low else ("high", inner.high)
            words.append(
                f"The inner setpoint of {inner.measurement} stands at a limit for "
                f"{100.0 * share:.0f} % of the time, mostly at its {end} limit of "
                f"{shown(limit, inner.signal)}: the outer loop controls nothing for most of it; "
                f"widen setpoint_{end} of the inner loop, or ask for less."
            )
    return words
