"""One controller tried: warned about, simulated and scored."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

from clepsydra.base.errors import ClepsydraError
from clepsydra.base.remark import Remark
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.loop.inner_setpoints import inner_setpoints
from clepsydra.loop.loop import Loop
from clepsydra.scores.evaluate import score_run
from clepsydra.scores.plant import plant_trajectories
from clepsydra.scores.scored_run import ScoredRun
from clepsydra.studies.ranking import Trial
from clepsydra.studies.warnings.after import caveats_after, warnings_after
from clepsydra.studies.warnings.before import caveats_before, warnings_before
from clepsydra.studies.warnings.caveat import Caveat
from clepsydra.studies.warnings.loop_response import LoopResponse, loop_response
from clepsydra.studies.warnings.overshooting import overshooting

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.linear.linear_model import LinearModel
    from clepsydra.loop.run import Run
    from clepsydra.loop.scenario import Scenario
    from clepsydra.studies.tuning.result import TuningResult

#: A loop that noise drives from limit to limit converges slowly; its estimate is then told.
REFINEMENT = 4


def trial_of(
    controller: Controller,
    model: LinearModel,
    scenario: Scenario,
    tuning: TuningResult | None = None,
    run: Run | None = None,
) -> Trial:
    """Return what a controller does in a scenario, and what is to be said of it.

    Parameters
    ----------
    model : LinearModel
        With all measurements, at the operating point where the scenario begins.
    tuning : TuningResult, optional
        How the controller was tuned.
    run : Run, optional
        What it does, where that is known.
    """
    switches = not controller.setpoints
    response: LoopResponse | None = None
    if not switches:
        with suppress(ClepsydraError):  # the warnings say why there is none
            response = loop_response(controller, model)
    before = warnings_before(model, controller, scenario, response)
    loop = Loop(controller, model)
    if run is None:
        # Halving the step of a loop of switches moves a switch by a sample, and converges to
        # nothing.
        run = loop.run(scenario) if switches else loop.run_checked(scenario, REFINEMENT)
    scores = scores_of(run)
    peak = math.nan
    if not switches:
        linear = sampled_loop(controller, model) if response is None else response.loop
        peak = linear.maximum_sensitivity
    return Trial(
        controller=controller,
        run=run,
        scores=scores,
        maximum_sensitivity=peak,
        warnings=(*before, *warnings_after(run, scores)),
        caveats=(
            *_state_of(tuning),
            *caveats_before(model, controller, scenario),
            *caveats_after(run),
        ),
        response=response,
        tuning=tuning,
        overshoots=overshooting(run, model, scores),
    )


def _state_of(tuning: TuningResult | None) -> tuple[Caveat, ...]:
    """Return whether a tuning was cut short, and whether it left an earlier one behind."""
    if tuning is None:
        return ()
    found = []
    if tuning.interrupted:
        words = Remark(
            f"The tuning was interrupted after {tuning.evaluations} candidates, and this is the "
            "best of them",
            remedy="run the same study again, and it goes on from there",
        )
        found.append(Caveat(words, "tuning"))
    if tuning.instead_of is not None:
        words = Remark(
            f"The tuning began afresh, since {tuning.instead_of} held an interrupted one of "
            "another problem",
            "the process, the scenario, the objective, the limits or the bounds have changed",
        )
        found.append(Caveat(words, f"tuning of {tuning.controller.name}"))
    return tuple(found)


def scores_of(run: Run) -> dict[str, float]:
    """Return every score of a run; errors are those of the true levels, without noise."""
    process = run.process
    scored = ScoredRun(
        run.time,
        {name: run.values[f"{name}.setpoint"] for name in process.controlled},
        {name: run.true_measurement(name) for name in process.controlled},
        {u.name: run.values[u.name] for u in process.inputs},
        {u.name: (u.low, u.high) for u in process.inputs},
        run.scenario.segments,
        measured={name: run.values[name] for name in process.controlled},
        plant=plant_trajectories(process, run.time, run.values),
        followed=run.controller.setpoints,
        movable={u.name: run.limits(u.name) for u in process.inputs},
        inner={
            each.name.replace(".inner_setpoint", ""): (run.values[each.name], each.low, each.high)
            for each in inner_setpoints(run.controller, process)
        },
    )
    return score_run(scored)
