"""What a tuning is for, and within which limits, where nobody says: by what a study ranks."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.designs.applicability import NotApplicable
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.linear.linearise import operating_point_of
from clepsydra.loop.loop import Loop
from clepsydra.loop.running_scores import RunningScores
from clepsydra.studies.judge import usual_criteria
from clepsydra.studies.ranking import QUIET
from clepsydra.studies.trial import scores_of
from clepsydra.studies.tuning.objective import Goal, Limits, Objective, mean
from clepsydra.studies.warnings.overshooting import OVERSHOOT

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.loop.run import Run
    from clepsydra.loop.scenario import Scenario
    from clepsydra.process.process import Process

#: Smallest damping ratio of the loops of a process whose levels average [1].
DAMPING = 0.7
#: Noise may move an input by this share of what makes a controller nervous: the search and the run
#: that is ranked differ by rounded numbers only.
NOISE_MOVEMENT = 0.9 * QUIET
#: What averages may take so many times as long to come to rest as the controller that is tuned:
#: with a damping of 0.7 instead of 1, in the same room, it takes 1.14 times as long.
_REST = 2.0


def usual_goal(
    controller: Controller,
    model: LinearModel,
    scenario: Scenario,
    limits: Limits | None = None,
    objective: Objective | None = None,
) -> Goal:
    """Return the goal of a tuning: what ranks a study, within limits that a plant engineer has.

    Parameters
    ----------
    controller : Controller
        That is tuned: scores count beside its own. A level that averages and has no band keeps the
        room that it uses.
    model : LinearModel
        With all measurements, at the operating point where the scenario begins.
    limits : Limits, optional
        Others than the usual.
    objective : Objective, optional
        What somebody tunes for; levels then keep no other room than their bands. Without it what
        averages comes to rest between one load step and the next, or within twice the time that
        it takes already: a basin of days would otherwise be tuned for less room than it uses.

    Raises
    ------
    NotApplicable
        As `usual_objective`.
    """
    limits = limits or usual_limits(operating_point_of(model).process)
    if objective is not None:
        return Goal(model, scenario, objective, limits)
    run = Loop(controller, model).run(scenario)
    if run.process.averaging:
        loads = [each for each in scenario.segments if each.kind == "load"]
        between = min((each.stop - each.start for each in loads), default=math.inf)
        own = sampled_loop(controller, model).decay * scenario.sampling_period
        rest = max(between, _REST * own) if math.isfinite(own) else between
        limits = replace(limits, levels=levels_used(run), rest=rest)
    return Goal(model, scenario, usual_objective(run), limits)


def usual_limits(process: Process) -> Limits:
    """Return what a tuned controller keeps where nobody says otherwise.

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> limits = usual_limits(load_process("three-tanks"))
    >>> limits.maximum_sensitivity, limits.overshoot_if_stepped, limits.damping
    (2.0, 10.0, 0.0)
    """
    return Limits(
        SENSITIVITY_LIMIT,
        overshoot_if_stepped=OVERSHOOT,
        noise_movement=NOISE_MOVEMENT,
        damping=DAMPING if process.averaging else 0.0,
    )


def usual_objective(run: Run) -> Objective:
    """Return the mean of what ranks the controllers of a process, relative to a run.

    Parameters
    ----------
    run : Run
        Of the controller that is tuned.

    Raises
    ------
    NotApplicable
        What ranks is not known while a loop runs, or is nothing already.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> usual_objective(cl.simulate(plant, cl.design.simc(plant))).words
    'the mean of setpoint error of level_3 and load error of level_3, each relative to the start'
    """
    process, scores = run.process, scores_of(run)
    criteria = usual_criteria(process, scores)
    weights = {
        key: 1.0 / len(keys)
        for keys in criteria.values()
        for key in keys
        if math.isfinite(scores[key]) and scores[key] > 0.0
    }
    if not weights:
        raise NotApplicable(f"{' and '.join(criteria)} leave nothing to lessen")
    if set(weights.values()) == {weights[next(iter(weights))]}:
        weights = dict.fromkeys(weights, 1.0)
    try:
        RunningScores(process, tuple(weights)).inputs_of(run.scenario)
    except InputError as refusal:
        words = f"what ranks it is not known of {refusal.value}"
        raise NotApplicable(words) from None
    return mean(weights)


def levels_used(run: Run) -> dict[str, tuple[float, float]]:
    """Return the band around its first value that each averaging level without a band kept [m].

    The band reaches as far down as up: a run whose loads only filled a tank says as much about
    the room below.
    """
    process = run.process
    found = {}
    for name in process.averaging:
        state = process.measured_state.get(name)
        if state in process.levels and name not in process.bands:
            level, first = run.values[state], float(run.values[state][0])
            room = float(np.max(np.abs(level - first)))
            if room > 0.0:
                found[state] = (first - room, first + room)
    return found
