"""The physical limit of a study's scenario, kept for the next study of the same plant."""

from __future__ import annotations

from collections.abc import Callable

from clepsydra.limits.limits import LimitProgress, Limits, limits_of
from clepsydra.studies.kept_work import KeptWork
from clepsydra.studies.result import StudyResult


def limits_of_study(
    result: StudyResult, progress: Callable[[LimitProgress], None] | None = None
) -> Limits:
    """Return the limits of the setpoint events of a study, found now or by an earlier study.

    Parameters
    ----------
    result : StudyResult
    progress : callable, optional
        Takes how far the search is, before each event.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> found = cl.study(plant, [cl.design.simc(plant)], [cl.step("level_3", "+1 cm", at="9 s")])
    >>> limits = limits_of_study(found)
    >>> round(limits.index, 1), round(limits.times(found.best.run), 1)
    (35.4, 3.7)
    """
    scenario = result.scenario
    loads = scenario.quiet_disturbances
    asked = (
        "physical limit",
        scenario.setpoints,
        scenario.disturbances if loads is None else loads,
        scenario.segments,
        scenario.begin is None,
    )
    return KeptWork(result.point).outcome(
        asked, lambda: limits_of(scenario, result.model, progress=progress)
    )
