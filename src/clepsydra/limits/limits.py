"""The limits of a whole scenario, and how many times them a run is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from clepsydra.limits.checks import check_between, check_moved, rest_asked, too_short
from clepsydra.limits.event import Event
from clepsydra.limits.limit import Limit, limit_of
from clepsydra.limits.replay import errors_of
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.default_scenario import STEP_SHARE
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.optimal_control.refusal import refusal
from clepsydra.optimal_control.search import NoCourse
from clepsydra.process.process import Process
from clepsydra.scores.segment import Segment

_IMPOSSIBLE = "no input between its limits brings the plant to rest at the new setpoint"
_UNKNOWN = "the search for the best input did not come to an end"
_ELSEWHERE = (
    "simulated, the input that the search found leaves quite another error than it promised"
)
#: A limit that differs by more from its simulation says nothing of the plant.
_LOST = 0.1


@dataclass(frozen=True)
class NoLimit:
    """A setpoint event without a limit.

    Parameters
    ----------
    segment : Segment
    reason : str
        A sentence without its end.
    """

    segment: Segment
    reason: str


@dataclass(frozen=True)
class LimitProgress:
    """How far the search for limits is: so many events `done` `of` all, and the next one's `name`.

    Examples
    --------
    >>> LimitProgress(1, 4, "limit of level_1 at 660 s").done
    1
    """

    done: int
    of: int
    name: str


@dataclass(frozen=True, eq=False)
class Limits:
    """The limit of every setpoint event of a scenario.

    Parameters
    ----------
    process : Process
    found : tuple of Limit
        In order of time.
    refused : tuple of NoLimit
    """

    process: Process
    found: tuple[Limit, ...]
    refused: tuple[NoLimit, ...] = ()

    @property
    def proved(self) -> tuple[Limit, ...]:
        """Those whose proofs hold."""
        return tuple(each for each in self.found if each.accepted)

    @property
    def index(self) -> float:
        """The sum of those that are proved: of each error's integral over its step [s]."""
        return sum(each.index for each in self.proved)

    def times(self, run: Run) -> float | None:
        """Return the summed error of a run in these events as a multiple of their limits.

        It is None where there is no proved limit, or the run has not the scenario.
        """
        proved = self.proved
        if not proved or not all(_has(run, each.event) for each in proved):
            return None
        return sum(_index_of(run, each.event) for each in proved) / self.index

    def as_dict(self, *, courses: bool = True) -> dict[str, Any]:
        """Return the limits as values for JSON, in SI, with the courses that reach them."""
        return {
            "process": self.process.name,
            "index": self.index if self.proved else None,
            "events": [_as_dict(each, courses=courses) for each in self.found],
            "without_limit": [
                {"event": asdict(each.segment), "reason": each.reason} for each in self.refused
            ],
        }


def limits_of(
    scenario: Scenario,
    linear: LinearModel,
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    overshoot: bool = True,
    extend: bool = True,
    progress: Callable[[LimitProgress], None] | None = None,
) -> Limits:
    """Find the limit of every setpoint event of a scenario, without noise.

    Parameters
    ----------
    scenario : Scenario
    linear : LinearModel
        Of the process at the operating point where it begins.
    bounds : mapping, optional
        Input to the ends between which it may move; its range if left out [SI].
    overshoot : bool
        Whether the output that steps may go beyond its setpoint.
    extend : bool
        Whether a horizon may be longer than its segment where the limit asks for it.
    progress : callable, optional
        Takes how far the search is, before each event.

    Raises
    ------
    InputError
        No input moves an output, the plant does not rest at a setpoint, or not between the bounds,
        or a horizon that may not be longer is too short.
    """
    point = operating_point_of(linear)
    process = point.process
    judged = tuple(name for name in process.controlled if name not in process.averaging)
    reason = refusal(point, judged)
    if scenario.begin is not None:
        reason = "it does not begin at rest"
    segments = [each for each in scenario.segments if each.kind == "setpoint"]
    check_moved(linear, [each.signal for each in segments])
    if reason:
        return Limits(process, (), tuple(NoLimit(each, reason) for each in segments))
    found: list[Limit] = []
    refused: list[NoLimit] = []
    for done, segment in enumerate(segments):
        if progress is not None:
            name = f"limit of {segment.signal} at {segment.start:g} s"
            progress(LimitProgress(done, len(segments), name))
        if segment.signal not in judged:
            refused.append(NoLimit(segment, refusal(point, ())))
            continue
        event = _event(scenario, linear, segment, judged, bounds or {}, overshoot)
        check_between(event)
        try:
            limit = limit_of(event, linear, extend=extend)
            if limit.proofs.replay > _LOST:
                refused.append(NoLimit(segment, _ELSEWHERE))
            else:
                found.append(limit)
        except NoCourse as none:
            if none.impossible and not extend:
                raise too_short(event) from None
            refused.append(NoLimit(segment, _IMPOSSIBLE if none.impossible else _UNKNOWN))
    return Limits(process, tuple(found), tuple(refused))


def _event(
    scenario: Scenario,
    linear: LinearModel,
    segment: Segment,
    judged: tuple[str, ...],
    bounds: Mapping[str, tuple[float, float]],
    overshoot: bool,
) -> Event:
    point = operating_point_of(linear)
    process, first = point.process, scenario.sample_of(segment)
    last = min(round(segment.stop / scenario.sampling_period), scenario.samples)
    columns = [process.controlled.index(name) for name in judged]
    loads = (
        scenario.disturbances
        if scenario.quiet_disturbances is None
        else scenario.quiet_disturbances
    )
    asked = [scenario.setpoints[place].tolist() for place in (max(first - 1, 0), last - 1)]
    rests = [
        rest_asked(point, dict(zip(process.controlled, values, strict=True)), loads[place], segment)
        for values, place in zip(asked, (first, last - 1), strict=True)
    ]
    return Event(
        segment=segment,
        outputs=judged,
        steps=np.array(list(_steps(scenario, process, segment, judged))),
        start=rests[0],
        target=rests[1],
        setpoints=scenario.setpoints[first:last][:, columns],
        disturbances=loads[first:last],
        bounds=bounds,
        overshoot=overshoot,
    )


def _steps(
    scenario: Scenario, process: Process, segment: Segment, judged: tuple[str, ...]
) -> Iterator[float]:
    """Yield what the error of each output is divided by.

    It is its own largest step in the scenario; of one that never steps the same share of its range
    as the event is of that which steps.
    """
    span = process.signal(segment.signal).span
    for name in judged:
        own = [
            abs(each.size)
            for each in scenario.segments
            if (each.kind, each.signal) == ("setpoint", name)
        ]
        share = abs(segment.size) / span if np.isfinite(span) else STEP_SHARE
        yield max(own) if own else share * process.signal(name).span


def _has(run: Run, event: Event) -> bool:
    """Whether a run has the setpoints of an event, sample by sample."""
    first = run.scenario.sample_of(event.segment)
    columns = [run.process.controlled.index(name) for name in event.outputs]
    asked = run.scenario.setpoints[first : first + event.samples][:, columns]
    return np.array_equal(asked, event.setpoints)


def _index_of(run: Run, event: Event) -> float:
    """Return the summed error of a run in an event, each over its step [s]."""
    first = run.scenario.sample_of(event.segment)
    stretch = slice(first, first + event.samples + 1)
    time = run.time[stretch]
    true = {name: run.true_measurement(name)[stretch] for name in event.outputs}
    errors = errors_of(event, time, true)
    return sum(errors[name] / size for name, size in event.sizes)


def _as_dict(limit: Limit, *, courses: bool) -> dict[str, Any]:
    event, best = limit.event, limit.best
    found = {
        "event": asdict(event.segment),
        "index": limit.index,
        "errors": limit.errors,
        "steps": dict(event.sizes),
        "horizon": limit.horizon,
        "accepted": limit.accepted,
        "proofs": limit.proofs.named,
    }
    if not courses:
        return found
    names = [*event.outputs, *(u.name for u in event.process.inputs)]
    course = {name: best.values[name].tolist() for name in names}
    return {**found, "course": {"time": best.time.tolist(), **course}}
