"""The course that reaches the physical limit, behind that of a controller."""

from __future__ import annotations

from dataclasses import replace

from clepsydra.base.section import Picture
from clepsydra.limits.limits import Limits
from clepsydra.loop.run import Run
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.report.overlay_picture import overlay_svg
from clepsydra.studies.result import Candidate, StudyResult


def limit_picture(result: StudyResult, candidate: Candidate, limits: Limits) -> Picture | None:
    """Return levels and inputs of a controller and of the best course; None where there is none."""
    found = {each.event.segment for each in limits.proved}
    named = replace(candidate.controller, name="the best possible", slowed=1.0)
    best = replace(candidate, controller=named, run=_best_run(candidate.run, limits))
    both = [candidate, best]
    signals = [each for each in shown_signals(result) if not each.inner]
    windows = [each for each in event_windows(result, signals, both) if each.segment in found]
    if not windows:
        return None
    name = candidate.controller.title
    title = f"What {name} makes of setpoint steps, and the best course that any input could make"
    return Picture(overlay_svg(windows, signals, both, title), f"{title}.")


def _best_run(run: Run, limits: Limits) -> Run:
    """Return a run in which each event with a limit goes as well as it can."""
    values = {name: column.copy() for name, column in run.values.items()}
    for limit in limits.proved:
        first = run.scenario.sample_of(limit.event.segment)
        stretch = slice(first, first + limit.event.samples)
        for name in values.keys() & limit.best.values.keys():
            values[name][stretch] = limit.best.values[name][: limit.event.samples]
    return replace(run, values=values)
