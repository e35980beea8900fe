"""Events as the scenario of a closed loop."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.base.words import time_text
from clepsydra.interface.events import changes_of
from clepsydra.interface.quantities import Quantity, read_time
from clepsydra.loop.default_scenario import MOST_SAMPLES, default_scenario, segment_samples
from clepsydra.loop.profile import Change, samples_before
from clepsydra.loop.scenario import Scenario, Segment, scenario_of_changes

if TYPE_CHECKING:
    from clepsydra.interface.plant import Plant
    from clepsydra.loop.begin import Begin


def scenario_of(
    plant: Plant,
    events: object = None,
    duration: Quantity | None = None,
    seed: int = 1,
    begin: Begin | None = None,
) -> Scenario:
    """Return exactly these events, without noise; without events the default scenario.

    Where it begins away from rest there is no default scenario: without events it is the way to
    the setpoints of the operating point.

    Parameters
    ----------
    plant : Plant
    events : sequence of Event, optional
    duration : str or float, optional
        "20 min"; a number is in s. If left out, as long after the last event as the default
        scenario would wait.
    seed : int
        Of the noise of the default scenario.
    begin : Begin, optional
        At rest if left out.

    Raises
    ------
    InputError
        An event is wrong, or the scenario has no length or is too long.
    """
    period = plant.process.sampling_period
    if events is None and duration is None and begin is None:
        return default_scenario(plant.linear, seed)
    changes = changes_of(events or [], plant, controlled=True)
    length = _length(plant, changes, duration, begin)
    samples = samples_before(length, period)
    if samples < 2:
        raise InputError(
            "duration", time_text(length, 4), f"at least {time_text(2 * period, 4)}, two samples",
            "lengthen it, or shorten the sampling period of the process",
        )  # fmt: skip
    if samples > MOST_SAMPLES:
        raise InputError(
            "duration", time_text(length, 4),
            f"at most {time_text(MOST_SAMPLES * period, 4)}, {MOST_SAMPLES:,} sampling periods",
            "shorten it, or lengthen the sampling period of the process",
        )  # fmt: skip
    scenario = scenario_of_changes(plant.point, changes, samples, (), seed, begin)
    segments = _segments(changes, plant, samples)
    if begin is not None:
        from clepsydra.loop.beginning import with_beginning

        end = samples * period
        segments = with_beginning(plant.process, begin, scenario.setpoints[0], segments, end)
    return replace(scenario, segments=tuple(segments))


def _length(
    plant: Plant, changes: list[Change], duration: Quantity | None, begin: Begin | None
) -> float:
    if duration is not None:
        length = read_time("simulation", "duration", duration)
        if length == 0.0:
            raise InputError(
                "simulation, duration", duration, "a time above 0 s", "write as in '20 min'"
            )
        return length
    period = plant.process.sampling_period
    rest, each = segment_samples(plant.linear)
    nothing = rest * period if begin is None else 0.0
    last = max((change.end for change in changes), default=nothing)
    return last + each * period


def _segments(changes: list[Change], plant: Plant, samples: int) -> list[Segment]:
    """Return a stretch for each step that comes alone: only then is it known what it does."""
    process, period = plant.process, plant.process.sampling_period
    groups = [
        (start, list(group))
        for start, group in groupby(changes, key=lambda each: samples_before(each.start, period))
    ]
    now, found = plant.point.as_dict(), []
    for place, (start, group) in enumerate(groups, start=1):
        end = groups[place][0] if place < len(groups) else samples
        change = group[0]
        setpoint = change.signal in process.controlled
        # A setpoint that goes back at once is followed nowhere, so that nothing is to be judged.
        if len(group) == 1 and not change.is_ramp and not (setpoint and change.back):
            found.append(
                Segment(
                    "setpoint" if setpoint else "load",
                    change.signal,
                    start * period,
                    end * period,
                    change.value - now[change.signal],
                    change.end - change.start,
                )
            )
        now |= {change.signal: change.value for change in group if change.back is None}
    return found
